// Methods froxels, lit and gradients: against the reference, against closed forms, and what viewers share.
#include <gtest/gtest.h>

#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::froxels_test {
namespace {

class FroxelsTest : public JudgedTest {
protected:
    static Scene emptyScene() {
        Scene scene;
        scene.medium.layout = Layout::none;
        scene.lights.clear();
        scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
        scene.render.froxels = {.pixels = 2, .slices = 256};
        return scene;
    }
    static Light point(glm::vec3 position) { return {.type = kPoint, .position = position, .intensity = {90, 80, 60}}; }
    // Relative RMSE of total radiance by all methods that march froxels. `lit`: of those that keep light at nodes.
    static void judgeAll(Scene scene, std::initializer_list<Pose> poses, double froxels, double lit) {
        for (const char* method : some({"froxels", "lit", "gradients"})) {
            scene.render.method = method;
            double most = 0;
            for (const Pose& pose : poses) {
                const Error error = errorOf(scene, pose);
                std::printf("%-9s %.3f %%, worst pixel %.2f %%\n", method, 100 * error.rmse, 100 * error.worst);
                most = std::max(most, error.rmse);
            }
            EXPECT_LE(most, scene.render.method == "froxels" ? froxels : lit) << method;
        }
    }
};

const Pose kOutside = lookAt({2, 3, 14}, {0, 0, 0}, 0.9f), kInside = lookAt({0.5f, 0.3f, 1}, {0, 0, -5}, 1.0f);

TEST_F(FroxelsTest, ACloud) {
    Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 0.35f), 1.6f);
    scene.medium.anisotropy = 0.7f;
    scene.medium.asymmetry = 0.5f;
    scene.render.froxels = {.pixels = 1, .slices = 256};
    judgeAll(scene, {kOutside, kInside}, 0.01, 0.01);
}

TEST_F(FroxelsTest, HeightFogOverTheGround) {
    Scene scene = emptyScene();
    scene.lights = {{.to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.2f))}};
    scene.fogs = {{.extinction = 0.05f, .height = -4, .falloff = 0.2f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    judgeAll(scene, {kOutside, kInside}, 5e-3, 5e-3);
}

TEST_F(FroxelsTest, ShaftsBetweenObjects) {
    Scene scene = emptyScene();
    scene.lights = {{.to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.2f))}};
    scene.fogs = {{.extinction = 0.05f, .falloff = 0.2f, .albedo = {0.9f, 0.8f, 0.7f}}}; // the sun comes through
    scene.boxes = {{{2, -1, 0}, {1, 6, 1}, 0.4f, glm::vec3(0.6f)}, {{-4, -3, 3}, {2, 2, 2}, 0, glm::vec3(0.3f)}};
    scene.spheres = {{{-1, 1, 1}, 0.8f, glm::vec3(0.5f)}};
    scene.render.radiance.spacing = 0.1f;
    judgeAll(scene, {kOutside, kInside}, 0.02, 0.02);
}

TEST_F(FroxelsTest, PointsAndSpotsPastObjects) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.05f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.boxes = {{{2, -1, 0}, {1, 6, 1}, 0.4f, glm::vec3(0.6f)}};
    scene.lights = {point({0.5f, 2.5f, 2}), point({-5, 4, -1})};
    scene.lights[1].type = kSpot;
    scene.lights[1].axis = glm::normalize(glm::vec3(1, -0.7f, 0.3f));
    scene.render.radiance.spacing = 0.15f;
    scene.render.froxels.pixels = 1;
    judgeAll(scene, {kOutside}, 0.03, 0.03);
}

// The beam of a spot beside the eye goes on as far as its light does.
TEST_F(FroxelsTest, ABeamThatGoesFarAway) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.02f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.lights = {point({0, 0, -3})};
    scene.lights[0].type = kSpot;
    scene.lights[0].axis = {0, 0, -1};
    scene.lights[0].intensity = glm::vec3(2000);
    scene.lights[0].range = 30;
    scene.render.froxels.pixels = 1;
    judgeAll(scene, {lookAt({4, 1, 2}, {0, 0, -25}, 0.5f)}, 0.02, 0.03);
}

// Sun et al., A practical analytic single scattering model for real time rendering, 2005: a point of 2 W/sr 4 m away in
// fog of 0.3 1/m, 0.5 rad beside the line of sight, which ends after 9 m. The value is an integral in double.
TEST_F(FroxelsTest, APointInFogHasItsClosedForm) {
    Scene scene = emptyScene();
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0)};
    scene.fogs = {{.extinction = 0.3f, .albedo = glm::vec3(1)}};
    Light light = point(glm::vec3(std::sin(0.5f), 0, -std::cos(0.5f)) * 4.0f);
    light.intensity = glm::vec3(2);
    light.shadows = false;
    scene.lights = {light};
    scene.boxes = {{{0, 0, -59}, {200, 200, 100}, 0, glm::vec3(0)}};
    scene.render.froxels = {.pixels = 1, .slices = 512};
    const double h = 4 * std::sin(0.5), foot = 4 * std::cos(0.5), sigma = 0.3;
    double expected = 0;
    constexpr int kSteps = 200000;
    for (int i = 0; i < kSteps; ++i) {
        const double t = kNear + (9 - kNear) * (i + 0.5) / kSteps, d = std::hypot(h, t - foot);
        expected += std::exp(-sigma * (t - kNear + d)) / (d * d) * (9 - kNear) / kSteps;
    }
    expected *= sigma * 2 / (4 * kPi);
    for (const char* method : some({"froxels", "lit", "gradients"})) {
        scene.render.method = method;
        const Picture picture = render(device(), scene, lookAt({0, 0, 0}, {0, 0, -1}, 0.02f), 33, 33);
        std::printf("%s: %.2e\n", method, double(picture.at(16, 16).r) / expected - 1);
        EXPECT_NEAR(picture.at(16, 16).r / expected, 1, 1e-4) << method;
        EXPECT_NEAR(picture.at(16, 16).a / std::exp(-sigma * (9 - kNear)), 1, 1e-4) << method;
    }
}

// Light from everywhere in a medium that absorbs nothing is the same inside it, however coarse froxels are.
TEST_F(FroxelsTest, AFurnaceHasNoColour) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.4f, .falloff = 0.1f, .albedo = glm::vec3(1)}};
    scene.sky = {.zenith = glm::vec3(1), .horizon = glm::vec3(1), .ambient = glm::vec3(1)};
    for (const uint32_t slices : {8u, 128u}) {
        scene.render.froxels = {.pixels = 1, .slices = slices};
        for (const char* method : some({"froxels", "lit", "gradients"})) {
            scene.render.method = method;
            const Picture picture = render(device(), scene, kInside, 64, 36);
            float off = 0;
            for (const glm::vec4& pixel : picture.pixels)
                for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(pixel[c] - 1));
            std::printf("%s, %u slices: %.1e\n", method, slices, double(off));
            EXPECT_LE(off, 1e-5f) << method << ", " << slices;
        }
    }
}

// A box behind the eye shadows the fog before it by rays, and does not where shadows are not asked.
TEST_F(FroxelsTest, WithoutShadowsObjectsShadowNothing) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.05f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.lights = {{.to_light = glm::normalize(glm::vec3(0, 0.4f, 1))}, point({0, 1, 12})};
    // What slices reach is told by these two, whatever else there is.
    scene.spheres = {{{20, 20, 20}, 0.1f, glm::vec3(0.5f)}, {{-20, -20, -20}, 0.1f, glm::vec3(0.5f)}};
    Scene shadowed = scene;
    shadowed.boxes = {{{0, 0, 8}, {6, 6, 1}, 0, glm::vec3(0.5f)}};
    const Pose eye = lookAt({0, 0, 4}, {0, 0, -5}, 0.8f);
    const auto seen = [&](Scene& of, const char* shadows) {
        of.render.method = "froxels";
        of.render.froxels.shadows = shadows;
        return render(device(), of, eye, 48, 27).pixels;
    };
    const auto lit = seen(scene, "none"), still_lit = seen(shadowed, "none"), dark = seen(shadowed, "ray"),
               rays = seen(scene, "ray");
    EXPECT_EQ(still_lit, lit);
    const size_t middle = 13 * 48 + 24;
    EXPECT_NEAR(rays[middle].r / lit[middle].r, 1, 1e-3);
    EXPECT_LT(dark[middle].r, 0.8f * lit[middle].r);
}

// Shadows from the map, the grid and the frusta are those of rays: nearly, and not by asking rays.
TEST_F(FroxelsTest, EveryKindOfShadowIsThatOfRays) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.05f, .falloff = 0.2f, .albedo = {0.9f, 0.8f, 0.7f}}}; // the sun comes through
    scene.boxes = {{{2, -1, 0}, {1, 6, 1}, 0.4f, glm::vec3(0.6f)}, {{-4, -3, 3}, {2, 2, 2}, 0, glm::vec3(0.3f)}};
    scene.spheres = {{{-1, 1, 1}, 0.8f, glm::vec3(0.5f)}};
    scene.lights = {{.to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.2f))}, point({0.5f, 2.5f, 2})};
    scene.render.method = "froxels";
    scene.render.froxels = {.pixels = 4, .slices = 128};
    scene.render.shadow_grid.voxel = 0.08f;
    const auto seen = [&](const char* shadows) {
        scene.render.froxels.shadows = shadows;
        return render(device(), scene, kOutside, kWidth, kHeight);
    };
    const Picture by_rays = seen("ray");
    std::vector<glm::vec4> by_grid;
    for (const char* shadows : {"map", "grid", "hybrid"}) {
        const Picture picture = seen(shadows);
        if (std::string(shadows) == "grid") by_grid = picture.pixels;
        if (std::string(shadows) == "hybrid") {
            EXPECT_NE(picture.pixels, by_grid) << "near the eye, froxels of their own are asked";
        }
        double off = 0, all = 0;
        for (size_t i = 0; i < picture.pixels.size(); ++i) {
            const glm::dvec3 a(picture.pixels[i]), b(by_rays.pixels[i]);
            off += glm::dot(a - b, a - b), all += glm::dot(b, b);
        }
        std::printf("%-6s %.3f %%\n", shadows, 100 * std::sqrt(off / all));
        EXPECT_LE(std::sqrt(off / all), 0.01) << shadows;
        EXPECT_GT(off, 0) << shadows;
    }
}

// What is kept from one tick to the next is that of the scene as it is now.
TEST_F(FroxelsTest, WhatIsKeptFollowsTheScene) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.05f, .falloff = 0.2f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.boxes = {{{2, -1, 0}, {1, 6, 1}, 0.4f, glm::vec3(0.6f)}};
    scene.lights = {{.to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.2f))}, point({0.5f, 2.5f, 2})};
    scene.render.shadow_grid.voxel = 0.2f;
    scene.render.radiance.spacing = 0.2f;
    scene.render.froxels = {.pixels = 4, .slices = 64, .shadows = "grid"};
    Scene moved = scene, turned = scene, thicker = scene, darker = scene;
    moved.lights[1].position = {-2, 1, 1};
    turned.lights[0].to_light = glm::normalize(glm::vec3(-0.5f, 0.3f, 0.2f));
    thicker.fogs[0].extinction = 0.2f;
    darker.lights.pop_back();
    for (const char* method : some({"froxels", "lit", "gradients"})) {
        Stage stage(device(), scene, 1);
        for (Scene now : {scene, moved, turned, thicker, darker, scene}) {
            now.render.method = method;
            const Picture kept = stage.see(now, kOutside, 80, 48), fresh = render(device(), now, kOutside, 80, 48);
            EXPECT_EQ(kept.pixels, fresh.pixels) << method;
        }
    }
}

// An eye that keeps a part of its last picture's light.
class Remembering {
public:
    Remembering(const gpu::Device& device, const Scene& scene)
        : renderer_(device, scene, 1), submission_(device, "test") {
        renderer_.keepRadiance(true);
    }
    Picture see(const Scene& scene, const Pose& pose, uint64_t history) {
        const EyeRequest eye{.pose = pose, .width = 80, .height = 48, .history = history};
        submitAndWait(renderer_, submission_, Simulation(scene), {&eye, 1});
        return {80, 48, renderer_.readRadiance()};
    }

private:
    Renderer renderer_;
    Submission submission_;
};

double differenceOf(const Picture& a, const Picture& b) {
    double off = 0, all = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        const glm::dvec3 p(a.pixels[i]), q(b.pixels[i]);
        off += glm::dot(p - q, p - q), all += glm::dot(q, q);
    }
    return std::sqrt(off / all);
}

TEST_F(FroxelsTest, HistoryIsThatOfTheEyeAlone) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.05f, .falloff = 0.2f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.lights = {point({0.5f, 2.5f, 2})};
    scene.render.method = "froxels";
    scene.render.froxels = {.pixels = 4, .slices = 64};
    Scene kept = scene, moved = scene, moved_plain = scene;
    kept.render.froxels.history = moved.render.froxels.history = 0.9f;
    moved.lights[0].position = moved_plain.lights[0].position = {-2, 1, 2};
    const Pose beside = lookAt({2.3f, 3, 14}, {0, 0, 0}, 0.9f), away = lookAt({2, 3, 14}, {2, 3, 30}, 0.9f);
    Remembering eye(device(), scene);
    const Picture plain = eye.see(scene, kOutside, 1), plain_beside = eye.see(scene, beside, 1),
                  plain_moved = eye.see(moved_plain, kOutside, 1), plain_away = eye.see(scene, away, 1);
    // Whoever has none, or sees the place for the first time, sees what is there.
    EXPECT_EQ(eye.see(kept, kOutside, 0).pixels, plain.pixels);
    EXPECT_EQ(eye.see(kept, kOutside, 1).pixels, plain.pixels);
    // At rest nothing changes; a step aside finds the same light elsewhere in the picture.
    EXPECT_LE(differenceOf(eye.see(kept, kOutside, 1), plain), 1e-5);
    const double aside = differenceOf(eye.see(kept, beside, 1), plain_beside);
    std::printf("a step aside: %.3f %%\n", 100 * aside);
    EXPECT_LE(aside, 0.1); // froxels are 4 pixels wide, and a point is among them
    eye.see(kept, kOutside, 1);
    // A light that has moved fades in: a tenth of it is there, then a tenth of the rest.
    double before = differenceOf(plain, plain_moved);
    for (int i = 0; i < 5; ++i) {
        const double left = differenceOf(eye.see(moved, kOutside, 1), plain_moved);
        EXPECT_NEAR(left / before, 0.9, 0.03) << i;
        before = left;
    }
    // A cut forgets what was before; another eye never had it.
    EXPECT_LE(differenceOf(eye.see(kept, away, 1), plain_away), 1e-5);
    EXPECT_EQ(eye.see(kept, kOutside, 2).pixels, plain.pixels);
}

// Samples that lie elsewhere in each slice: the same in one tick, about the same light.
TEST_F(FroxelsTest, JitterIsThatOfTheTick) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.05f, .falloff = 0.2f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.lights = {{.to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.2f))}};
    scene.render.method = "froxels";
    scene.render.froxels = {.pixels = 1, .slices = 32};
    Scene jittered = scene;
    jittered.render.froxels.jitter = true;
    Stage stage(device(), scene, 1);
    const Picture plain = stage.see(scene, kOutside, 80, 48), one = stage.see(jittered, kOutside, 80, 48);
    EXPECT_EQ(stage.see(jittered, kOutside, 80, 48).pixels, one.pixels);
    const double off = differenceOf(one, plain);
    std::printf("jitter: %.3f %%\n", 100 * off);
    EXPECT_GT(off, 1e-4);
    EXPECT_LE(off, 0.1);
}

// Each channel of a medium that hides them differently has its own light at the nodes.
TEST_F(FroxelsTest, LitKeepsTheLightOfEachColour) {
    Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 1.2f), 1.6f);
    scene.medium.extinction_colour = {0.3f, 0.6f, 1};
    scene.lights = {{.to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.2f))}, point({4, 3, 2})};
    scene.render.froxels = {.pixels = 1, .slices = 128};
    scene.render.method = "froxels";
    const Picture each = render(device(), scene, kOutside, 80, 48);
    scene.render.method = "lit";
    const Picture kept = render(device(), scene, kOutside, 80, 48);
    for (int c = 0; c < 3; ++c) {
        double off = 0, all = 0;
        for (size_t i = 0; i < each.pixels.size(); ++i) {
            const double a = double(each.pixels[i][c]), b = double(kept.pixels[i][c]);
            off += (a - b) * (a - b), all += a * a;
        }
        EXPECT_LE(std::sqrt(off / all), 0.01) << c;
    }
}

// Where several lights of one colour meet, each keeps its own lobe.
TEST_F(FroxelsTest, LitKeepsTheLobeOfEachLight) {
    Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 1.2f), 1.6f);
    scene.medium.anisotropy = 1;
    scene.medium.asymmetry = 0.6f;
    scene.lights = {point({4, 3, 2}), point({-5, 1, 0}), point({1, -4, -3}), point({0, 2, -5})};
    scene.render.froxels = {.pixels = 1, .slices = 128};
    scene.render.method = "froxels";
    const Picture each = render(device(), scene, kOutside, 80, 48);
    scene.render.method = "lit";
    const double off = differenceOf(render(device(), scene, kOutside, 80, 48), each);
    std::printf("lit: %.2f %%\n", 100 * off);
    EXPECT_LE(off, 0.01);
}

// Light at nodes follows the colour of a medium at rest.
TEST_F(FroxelsTest, WhatIsKeptFollowsTheColourOfTheMedium) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 1.2f), 1.6f);
    scene.lights = {{.to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.2f))}, point({4, 3, 2})};
    scene.render.froxels = {.pixels = 4, .slices = 64};
    Scene red = scene, blue = scene;
    red.medium.extinction_colour = {1, 0.5f, 0.2f};
    blue.medium.extinction_colour = {0.2f, 0.5f, 1};
    for (const char* method : {"lit", "gradients"}) {
        Stage stage(device(), scene, 100);
        for (Scene now : {scene, red, blue, scene}) {
            now.render.method = method;
            const Picture kept = stage.see(now, kOutside, 80, 48), fresh = render(device(), now, kOutside, 80, 48);
            EXPECT_EQ(kept.pixels, fresh.pixels) << method;
        }
    }
}

// A picture whose froxels do not fit the buffer is drawn in bands of rows, and is as one that fits.
TEST_F(FroxelsTest, BandsAreNotSeen) {
    Scene scene = sceneOf({{.centre = {0, 0, 0}, .scale = 8, .sigma_t = 0.3f}}, 1);
    scene.render.method = "froxels";
    scene.render.froxels = {.pixels = 1, .slices = 512};
    const Pose pose = lookAt({0, 0, 9}, {0, 0, 0}, 0.6f);
    const Picture large = render(device(), scene, pose, 600, 96); // 460 MiB of froxels
    const Picture narrow = render(device(), scene, lookAt({0, 0, 9}, {0, 0, 0}, 0.6f), 96, 96);
    for (uint32_t y = 0; y < 96; ++y)
        for (uint32_t x = 0; x < 96; ++x) EXPECT_NEAR(large.at(x + 252, y).r, narrow.at(x, y).r, 2e-5) << x << ' ' << y;
}

} // namespace
} // namespace brume::test::froxels_test
