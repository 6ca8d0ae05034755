// Method march: against the reference, its filter against a plain one, and what must not depend on the pattern.
#include <gtest/gtest.h>

#include "shaders/shared/march.h"
#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::march_test {
namespace {

const Pose kOutside = lookAt({2, 3, 14}, {0, 0, 0}, 0.9f), kInside = lookAt({0.5f, 0.3f, 1}, {0, 0, -5}, 1.0f);

class MarchTest : public JudgedTest {
protected:
    static Scene emptyScene() {
        Scene scene;
        scene.medium.layout = Layout::none;
        scene.lights.clear();
        scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
        scene.render.method = "march";
        scene.render.march = {.samples = 256, .blur = "none"};
        return scene;
    }
    static Light sun() { return {.to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.2f))}; }
    static Light point(glm::vec3 position) { return {.type = kPoint, .position = position, .intensity = {90, 80, 60}}; }
    // Shafts of the sun between objects, which comes through the fog.
    static Scene shafts() {
        Scene scene = emptyScene();
        scene.lights = {sun()};
        scene.fogs = {{.extinction = 0.05f, .falloff = 0.2f, .albedo = {0.9f, 0.8f, 0.7f}}};
        scene.boxes = {{{2, -1, 0}, {1, 6, 1}, 0.4f, glm::vec3(0.6f)}, {{-4, -3, 3}, {2, 2, 2}, 0, glm::vec3(0.3f)}};
        scene.spheres = {{{-1, 1, 1}, 0.8f, glm::vec3(0.5f)}};
        return scene;
    }
    // Relative RMSE of total radiance with samples moved in each way.
    static void judgeAll(Scene scene, std::initializer_list<Pose> poses, double allowed) {
        for (const char* jitter : {"offset", "stratified", "opacity"}) {
            scene.render.march.jitter = jitter;
            double most = 0;
            for (const Pose& pose : poses) {
                const Error error = errorOf(scene, pose);
                std::printf("%-10s %.3f %%, worst pixel %.2f %%\n", jitter, 100 * error.rmse, 100 * error.worst);
                most = std::max(most, error.rmse);
            }
            EXPECT_LE(most, allowed) << jitter;
        }
    }
};

TEST_F(MarchTest, HeightFogOverTheGround) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = emptyScene();
    scene.lights = {sun()};
    scene.fogs = {{.extinction = 0.05f, .height = -4, .falloff = 0.2f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    judgeAll(scene, {kOutside, kInside}, 3e-3);
}

// Pixels that graze the ball err: as much with `froxels`.
TEST_F(MarchTest, ShaftsBetweenObjects) { judgeAll(shafts(), {kOutside, kInside}, 4e-3); }

TEST_F(MarchTest, ABallOfFog) {
    Scene scene = emptyScene();
    scene.lights = {sun()};
    scene.fogs = {{.extinction = 0.5f, .centre = {0, 0, -2}, .radius = 3, .albedo = {0.9f, 0.8f, 0.7f}}};
    judgeAll(scene, {kOutside, kInside}, 3e-3);
}

TEST_F(MarchTest, ASpotPastABox) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.05f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.boxes = {{{2, -1, 0}, {1, 6, 1}, 0.4f, glm::vec3(0.6f)}};
    scene.lights = {point({-5, 4, -1})};
    scene.lights[0].type = kSpot;
    scene.lights[0].axis = glm::normalize(glm::vec3(1, -0.7f, 0.3f));
    scene.render.march.jitter = "opacity";
    scene.render.march.dither = "none";
    const Error error = errorOf(scene, kOutside);
    std::printf("none       %.3f %%, worst pixel %.2f %%\n", 100 * error.rmse, 100 * error.worst);
    EXPECT_LE(error.rmse, 3e-3);
    // A pattern moves the sample that is nearest to the light: the few pixels around it differ much.
    scene.render.march.dither = "bayer8";
    judgeAll(scene, {kOutside}, 0.1);
}

TEST_F(MarchTest, ACloud) {
    Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 0.35f), 1.6f);
    scene.medium.anisotropy = 0.7f;
    scene.medium.asymmetry = 0.5f;
    scene.render.method = "march";
    scene.render.march = {.samples = 256, .blur = "none"};
    judgeAll(scene, {kOutside, kInside}, 0.01);
}

// Channels of a medium that hides them differently are marched one after the other.
TEST_F(MarchTest, ACloudThatHidesColoursDifferently) {
    Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 1.2f), 1.6f);
    scene.medium.extinction_colour = {0.3f, 0.6f, 1};
    scene.lights = {sun(), point({4, 3, 2})};
    scene.render.froxels = {.pixels = 1, .slices = 256};
    scene.render.march = {.samples = 128, .dither = "none", .jitter = "opacity", .blur = "none"};
    scene.render.method = "froxels";
    const Picture cells = render(device(), scene, kOutside, 80, 48);
    scene.render.method = "march";
    const Picture marched = render(device(), scene, kOutside, 80, 48);
    for (int c = 0; c < 4; ++c) {
        double off = 0, all = 0;
        for (size_t i = 0; i < cells.pixels.size(); ++i) {
            off += std::pow(double(cells.pixels[i][c]) - double(marched.pixels[i][c]), 2);
            all += std::pow(double(cells.pixels[i][c]), 2);
        }
        std::printf("channel %d: %.3f %%\n", c, 100 * std::sqrt(off / all));
        EXPECT_LE(std::sqrt(off / all), 0.02) << c;
    }
}

// Pixels of one place of the eye, all of which look the same way: together they have each offset once.
TEST_F(MarchTest, TheMeanOverAllOffsetsIsTheIntegral) {
    Scene scene = shafts();
    scene.sky.horizon = glm::vec3(0);
    const Pose pose = lookAt({2, 3, 14}, {-0.5f, -1, -1}, 1e-5f);
    const auto meanOf = [&](uint32_t samples, const char* jitter, const char* dither) {
        scene.render.march.samples = samples;
        scene.render.march.jitter = jitter;
        scene.render.march.dither = dither;
        const Picture picture = render(device(), scene, pose, 8, 8);
        glm::dvec3 sum(0);
        for (const glm::vec4& pixel : picture.pixels) sum += glm::dvec3(pixel);
        return sum / 64.0;
    };
    const glm::dvec3 truth = meanOf(256, "opacity", "bayer8");
    const auto offOf = [&](const glm::dvec3& mean) { return glm::length(mean - truth) / glm::length(truth); };
    const double opacity = offOf(meanOf(8, "opacity", "bayer8")), offset = offOf(meanOf(8, "offset", "bayer8")),
                 none = offOf(meanOf(8, "opacity", "none"));
    std::printf("8 samples: opacity %.4f %%, offset %.3f %%, none %.2f %%\n", 100 * opacity, 100 * offset, 100 * none);
    EXPECT_LE(opacity, 5e-4);
    EXPECT_LE(offset, 0.02); // the weight is the step's mean, wherever the sample lies
    EXPECT_GT(none, 1e-3);
}

// Light and opacity are blurred together, and light is then scaled to the pixel's own opacity.
std::vector<glm::dvec3> plainlyBlurred(const Picture& picture, uint32_t blur) {
    const int w = int(picture.width), h = int(picture.height);
    std::vector<glm::dvec4> values(picture.pixels.size());
    for (size_t i = 0; i < values.size(); ++i)
        values[i] = {glm::dvec3(picture.pixels[i]), 1 - double(picture.pixels[i].a)};
    for (const bool down : {false, true}) {
        std::vector<glm::dvec4> next(values.size());
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                glm::dvec4 sum(0);
                double weights = 0;
                for (int k = -int(gpu::kBlurReach); k <= int(gpu::kBlurReach); ++k) {
                    const int u = down ? x : x + k, v = down ? y + k : y;
                    if (u < 0 || v < 0 || u >= w || v >= h) continue;
                    const double weight = double(gpu::kBlurWeights[blur][k + int(gpu::kBlurReach)]);
                    sum += weight * values[size_t(v) * size_t(w) + size_t(u)];
                    weights += weight;
                }
                next[size_t(y) * size_t(w) + size_t(x)] = sum / weights;
            }
        values = next;
    }
    std::vector<glm::dvec3> result;
    for (size_t i = 0; i < values.size(); ++i)
        result.push_back(glm::dvec3(values[i]) * ((1 - double(picture.pixels[i].a)) / values[i].a));
    return result;
}

TEST_F(MarchTest, OnOneDepthTheFilterIsAPlainOne) {
    Scene scene = shafts();
    scene.render.march.samples = 4;
    scene.sky.horizon = glm::vec3(0);
    scene.boxes.push_back({{0, 0, -59}, {200, 200, 100}, 0, glm::vec3(0)}); // a black wall
    const Pose pose = lookAt({0, 0.5f, 2.5f}, {0, 0.5f, 0}, 0.5f);
    scene.boxes.erase(scene.boxes.begin(), scene.boxes.begin() + 2);
    scene.spheres = {{{1, 3, 1}, 0.8f, glm::vec3(0.5f)}};
    const Picture noisy = render(device(), scene, pose, 61, 45);
    const char* kNames[] = {"row14", "printed", "box8"};
    for (const uint32_t blur : {gpu::kBlurRow14, gpu::kBlurPrinted, gpu::kBlurBox8}) {
        scene.render.march.blur = kNames[blur];
        const Picture picture = render(device(), scene, pose, 61, 45);
        const std::vector<glm::dvec3> expected = plainlyBlurred(noisy, blur);
        double off = 0, moved = 0;
        for (size_t i = 0; i < expected.size(); ++i) {
            off = std::max(off, glm::length(glm::dvec3(picture.pixels[i]) / expected[i] - 1.0));
            moved = std::max(moved, glm::length(glm::dvec3(noisy.pixels[i]) / expected[i] - 1.0));
            EXPECT_EQ(picture.pixels[i].a, noisy.pixels[i].a); // fog's transmittance has no noise
        }
        std::printf("%s: off by %.1e where it changes %.2f\n", kNames[blur], off, moved);
        EXPECT_LE(off, 1e-5) << kNames[blur];
        EXPECT_GT(moved, 0.05) << kNames[blur];
    }
}

// What lies farther behind than the filter reaches does not change a bit in front of it.
TEST_F(MarchTest, AStepOfDepthKeepsTheBitsInFrontOfIt) {
    Scene near = shafts();
    near.lights = {point({0.5f, 2.5f, 2})};
    near.lights[0].shadows = false;
    near.spheres.clear();
    near.render.march = {.samples = 8};
    near.boxes = {{{0, 0, 5}, {2, 2, 0.2f}, 0, glm::vec3(0.5f)}, {{0, 0, -10}, {60, 60, 2}, 0, glm::vec3(0.2f)}};
    Scene far = near, close = near, closer = near;
    far.boxes[1].centre.z = -20;
    close.boxes[1].centre.z = 3, closer.boxes[1].centre.z = 3.5f; // its front is at 4 and 4.5, that of the first at 5.1
    const Pose pose = lookAt({0, 0, 14}, {0, 0, 0}, 0.6f);
    const auto changedOf = [&](const Scene& a, const Scene& b) {
        const Picture p = render(device(), a, pose, 96, 64), q = render(device(), b, pose, 96, 64);
        int changed = 0, front = 0;
        for (uint32_t y = 0; y < 64; ++y)
            for (uint32_t x = 0; x < 96; ++x) {
                const glm::dvec3 dir = pixelDirection(pose, 96, 64, x, y), at = dir * 8.9;
                if (std::abs(at.x) > 0.97 || std::abs(at.y) > 0.97) continue; // the front box is 2 m wide
                ++front;
                changed += p.at(x, y) != q.at(x, y);
            }
        EXPECT_GT(front, 300);
        return changed;
    };
    EXPECT_EQ(changedOf(near, far), 0);
    EXPECT_GT(changedOf(close, closer), 100); // within the filter's reach
}

// Light from everywhere in a medium that absorbs nothing is the same inside it, however few the samples.
TEST_F(MarchTest, AFurnaceHasNoColour) {
    Scene scene = emptyScene();
    scene.fogs = {{.extinction = 0.4f, .falloff = 0.1f, .albedo = glm::vec3(1)}};
    scene.sky = {.zenith = glm::vec3(1), .horizon = glm::vec3(1), .ambient = glm::vec3(1)};
    for (const char* jitter : {"offset", "stratified", "opacity"})
        for (const char* blur : {"none", "row14", "box8"})
            for (const uint32_t rate : {1u, 2u, 4u}) {
                scene.render.march = {.samples = 5, .jitter = jitter, .blur = blur};
                scene.render.rate = rate;
                const Picture picture = render(device(), scene, kInside, 65, 37);
                float off = 0;
                for (const glm::vec4& pixel : picture.pixels)
                    for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(pixel[c] - 1));
                EXPECT_LE(off, 1e-5f) << jitter << ", " << blur << ", " << rate;
            }
}

// The same with a sun: along rays that keep their height in a fog whose extinction falls with height, the sun's light
// is everywhere the same. Of an albedo of 1 such light is that of a furnace; of a smaller one it is in the picture
// once.
TEST_F(MarchTest, AFurnaceWithASunCountsTheAlbedoOnce) {
    constexpr float kExtinction = 0.1f, kFalloff = 0.5f; // at the eye's height
    constexpr double kAmbient = 0.4, kWall = 15;         // m to a black wall
    Scene scene = emptyScene();
    scene.lights = {sun()};
    scene.lights[0].irradiance = {9, 6, 3};
    scene.lights[0].shadows = false;
    scene.boxes = {{{0, 0, -float(kWall) - 50}, {400, 400, 100}, 0, glm::vec3(0)}};
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0), .ambient = glm::vec3(float(kAmbient))};
    const double through = std::exp(-double(kExtinction / kFalloff) / double(scene.lights[0].to_light.y));
    const glm::dvec3 source = kAmbient + glm::dvec3(scene.lights[0].irradiance) / (4 * kPi) * through;
    const double opacity = -std::expm1(-double(kExtinction) * (kWall - kNear));
    const auto worstBy = [&](const Picture& picture, const glm::dvec3& albedo) {
        double worst = 0;
        for (int c = 0; c < 3; ++c)
            worst = std::max(worst, std::abs(double(picture.at(16, 4)[c]) / (albedo[c] * source[c] * opacity) - 1));
        return worst;
    };
    for (const glm::vec3 albedo : {glm::vec3(1), glm::vec3(0.9f, 0.6f, 0.3f)})
        for (const char* jitter : {"offset", "stratified", "opacity"}) {
            scene.fogs = {{.extinction = kExtinction, .falloff = kFalloff, .albedo = albedo}};
            scene.render.march = {.samples = 5, .jitter = jitter, .blur = "none"};
            const Picture picture = render(device(), scene, lookAt({0, 0, 0}, {0, 0, -1}, 1e-3f), 33, 9);
            const double off = worstBy(picture, glm::dvec3(albedo)),
                         twice = worstBy(picture, glm::dvec3(albedo) * glm::dvec3(albedo));
            std::printf("%-10s albedo %.1f: %.1e, albedo twice %.2f\n", jitter, double(albedo.b), off, twice);
            EXPECT_LE(off, 1e-5) << jitter;
            EXPECT_TRUE(albedo == glm::vec3(1) || twice > 0.1) << jitter << ": this test sees no albedo";
        }
}

// Fewer pixels are marched, and what lies between them knows its own surface.
TEST_F(MarchTest, HalfAndQuarterResolution) {
    Scene scene = shafts();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.render.march = {.samples = 32, .jitter = "opacity"};
    const double allowed[] = {0.01, 0.02, 0.04};
    int i = 0;
    for (const uint32_t rate : {1u, 2u, 4u}) {
        scene.render.rate = rate;
        const Error error = errorOf(scene, kOutside);
        std::printf("rate %u: %.3f %%, worst pixel %.2f %%\n", rate, 100 * error.rmse, 100 * error.worst);
        EXPECT_LE(error.rmse, allowed[i++]) << rate;
    }
}

// A picture whose buffers would be too large is marched in bands of rows: 683 and 37 here. With half the pixels one
// band is enough.
TEST_F(MarchTest, BandsOfAWidePictureMeet) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = shafts();
    scene.render.march = {.samples = 4, .dither = "none"};
    constexpr uint32_t kColumns = 9000, kRows = 720, kSeam = 683;
    const Picture bands = render(device(), scene, kOutside, kColumns, kRows);
    scene.render.rate = 2;
    const Picture whole = render(device(), scene, kOutside, kColumns, kRows);
    for (const uint32_t first : {kSeam - 20, kSeam, kSeam + 17}) {
        double off = 0, all = 0;
        for (size_t i = size_t(first) * kColumns; i < size_t(first + 20) * kColumns; ++i) {
            const glm::dvec3 a(bands.pixels[i]), b(whole.pixels[i]);
            off += glm::dot(a - b, a - b), all += glm::dot(b, b);
        }
        std::printf("rows from %u: %.3f %%\n", first, 100 * std::sqrt(off / all));
        EXPECT_LE(std::sqrt(off / all), 0.02) << first;
    }
}

// What one viewer sees does not depend on who else looks, nor on when.
TEST_F(MarchTest, AViewerSeesTheSameAloneAndAmongOthers) {
    Scene scene = shafts();
    scene.render.march = {};
    scene.lights.push_back(point({0.5f, 2.5f, 2}));
    const Simulation simulation(scene);
    std::vector<EyeRequest> eyes;
    for (uint32_t i = 0; i < 6; ++i)
        eyes.push_back({.pose = lookAt({2.0f + float(i), 3, 14}, {0, 0, 0}, 0.9f), .width = 80 + 16 * i, .height = 48});
    const auto bytesOfFirst = [&](std::span<const EyeRequest> seen) {
        Renderer renderer(device(), scene, 1);
        Submission submission(device(), "test");
        submitAndWait(renderer, submission, simulation, seen);
        const PictureView& picture = submission.pictures().front();
        return std::vector<uint8_t>(picture.bytes, picture.bytes + picture.layout.bytes());
    };
    EXPECT_EQ(bytesOfFirst(std::span(eyes).first(1)), bytesOfFirst(eyes));
}

// Settings that change while the method is in use are those of the next picture.
TEST_F(MarchTest, EverySettingIsFollowed) {
    Scene scene = shafts();
    scene.render.march = {};
    Stage stage(device(), scene, 1);
    Picture before = stage.see(scene, kOutside, 80, 48);
    const auto follows = [&](const char* what, const auto& change) {
        change(scene.render);
        const Picture now = stage.see(scene, kOutside, 80, 48);
        EXPECT_NE(now.pixels, before.pixels) << what;
        EXPECT_EQ(now.pixels, render(device(), scene, kOutside, 80, 48).pixels) << what;
        before = now;
    };
    for (const char* dither : {"none", "white", "bayer4", "ign", "blue"})
        follows(dither, [&](RenderSettings& s) { s.march.dither = dither; });
    for (const char* jitter : {"stratified", "opacity"})
        follows(jitter, [&](RenderSettings& s) { s.march.jitter = jitter; });
    for (const char* blur : {"none", "printed", "box8", "row14"})
        follows(blur, [&](RenderSettings& s) { s.march.blur = blur; });
    follows("samples", [](RenderSettings& s) { s.march.samples = 3; });
    follows("rate", [](RenderSettings& s) { s.rate = 2; });
}

} // namespace
} // namespace brume::test::march_test
