// Media whose extinction differs among red, green and blue, against the reference and against grey media.
#include <gtest/gtest.h>

#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::extinction_colour_test {
namespace {

const Pose kOutside = lookAt({2, 3, 14}, {0, 0, 0}, 0.9f), kInside = lookAt({0.5f, 0.3f, 1}, {0, 0, -5}, 1.0f);

class ExtinctionColourTest : public JudgedTest {
protected:
    // A dense small cloud before a bright sky. Its extinction is that of green, half of it in red, and a tenth in blue.
    static Scene cloudScene() {
        Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 1), 1.6f);
        scene.lights[0].to_light = glm::normalize(glm::vec3(0.7f, 0.5f, 0.3f));
        scene.lights[0].irradiance = {12, 11, 9};
        scene.medium.anisotropy = 0.7f;
        scene.medium.asymmetry = 0.5f;
        scene.medium.extinction_colour = {0.4f, 0.8f, 0.08f};
        scene.sky = {.zenith = {0.2f, 0.35f, 0.6f}, .horizon = {0.6f, 0.65f, 0.7f}};
        scene.render.rate = 2;
        scene.render.slabs = 128;
        scene.render.shadow_size = 256;
        scene.render.shadow_slices = 65;
        return scene;
    }
    static void addObjects(Scene& scene) {
        scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
        scene.boxes = {{{5, -1, 0}, {1, 6, 3}, 0.4f, glm::vec3(0.6f)}};
    }
};

TEST_F(ExtinctionColourTest, Particles) { judge(cloudScene(), {kOutside, kInside}); }

TEST_F(ExtinctionColourTest, ParticlesOfManyAlbedos) {
    Scene scene = cloudScene();
    scene.sky.ambient = {0.3f, 0.4f, 0.5f};
    std::vector<Point> points = randomPoints(60, 5, 1.6f, 1);
    for (size_t i = 0; i < points.size(); ++i) points[i].albedo = {0.9f, i % 2 ? 0.2f : 0.9f, 0.5f};
    Scene varied = sceneOf(points, 1.6f);
    varied.lights = scene.lights, varied.sky = scene.sky, varied.render = scene.render;
    varied.medium.extinction_colour = scene.medium.extinction_colour;
    judge(varied, {kOutside, kInside});
}

TEST_F(ExtinctionColourTest, ParticlesAndFogsOfOtherColours) {
    Scene scene = cloudScene();
    addObjects(scene);
    scene.fogs = {{.extinction = 0, .extinction_colour = {1, 0, 0}}, // is not there
                  {.extinction = 0.05f, .height = -4, .falloff = 0.2f, .extinction_colour = {0.2f, 0.5f, 1}},
                  {.extinction = 0.4f, .hi = -3, .extinction_colour = {0, 1, 0.5f}}};
    judge(scene, {kOutside, kInside});
}

TEST_F(ExtinctionColourTest, FogAlone) {
    Scene scene = cloudScene();
    scene.medium.layout = Layout::none;
    scene.fogs = {{.extinction = 0.05f, .height = -2, .falloff = 0.3f, .extinction_colour = {0.3f, 0.6f, 1}}};
    judge(scene, {kOutside, kInside}, 2e-4);
}

TEST_F(ExtinctionColourTest, Lamps) {
    Scene scene = cloudScene();
    addObjects(scene);
    scene.render.rate = 1; // as LocalLightTest has it: the light of near particles is seen alone
    scene.lights.push_back({.type = kPoint, .position = {1, 1, 2}, .intensity = {300, 200, 100}});
    judge(scene, {kOutside, kInside});
}

// Each channel of a coloured medium is that of a grey medium with its extinction, with all methods.
TEST_F(ExtinctionColourTest, ChannelsAreThoseOfGreyMedia) {
    BRUME_WHOLE_LAYER_ONLY();
    for (const char* method : some({"slabs", "grid", "tiles", "sphere", "isv"}))
        for (const uint32_t step : {1u, 4u}) {
            Scene scene = cloudScene();
            addObjects(scene);
            scene.render.method = method;
            scene.render.rate = step, scene.render.grid.spacing = 0.5f;
            const Picture all = render(device(), scene, kOutside, kWidth, kHeight);
            const glm::vec3 parts = extinctionParts(scene.medium.extinction_colour);
            EXPECT_LT(glm::distance(parts, glm::vec3(0.5f, 1, 0.1f)), 1e-6f);
            glm::dvec3 off(0), values(0);
            double transmittance = 0;
            for (int c = 0; c < 3; ++c) {
                std::vector<Point> points = randomPoints(60, 5, 1.6f, parts[c]);
                Scene grey = sceneOf(points, 1.6f);
                grey.lights = scene.lights, grey.sky = scene.sky, grey.render = scene.render;
                grey.planes = scene.planes, grey.boxes = scene.boxes;
                grey.medium.anisotropy = scene.medium.anisotropy, grey.medium.asymmetry = scene.medium.asymmetry;
                const Picture one = render(device(), grey, kOutside, kWidth, kHeight);
                for (size_t i = 0; i < one.pixels.size(); ++i) {
                    const double apart = double(all.pixels[i][c]) - double(one.pixels[i][c]);
                    off[c] += apart * apart, values[c] += double(one.pixels[i][c]) * double(one.pixels[i][c]);
                    transmittance += double(one.pixels[i].a) / 3;
                }
            }
            for (const glm::vec4& pixel : all.pixels) transmittance -= double(pixel.a);
            const glm::dvec3 error = glm::sqrt(off / values);
            std::printf("%-6s step %u: %.5f %.5f %.5f %%\n", method, step, 100 * error.x, 100 * error.y, 100 * error.z);
            // Proxies are cut where the densest channel's end, and the grid's nodes are as far apart as its need.
            EXPECT_LT(std::max({error.x, error.y, error.z}), 2e-3) << method << ' ' << step;
            EXPECT_NEAR(transmittance / double(all.pixels.size()), 0, 1e-3) << method << ' ' << step;
        }
}

// What a channel's extinction of 0 leaves is the background, without a trace of the medium.
TEST_F(ExtinctionColourTest, AChannelWithoutExtinction) {
    for (const char* method : some({"slabs", "grid", "tiles", "sphere", "isv"})) {
        Scene scene = cloudScene(), bare = cloudScene();
        scene.render.method = bare.render.method = method;
        scene.render.grid.spacing = bare.render.grid.spacing = 0.5f;
        scene.medium.extinction_colour = {1, 1, 0};
        bare.medium.layout = Layout::none;
        const Picture with = render(device(), scene, kInside, kWidth, kHeight),
                      without = render(device(), bare, kInside, kWidth, kHeight);
        float apart = 0, changed = 0;
        for (size_t i = 0; i < with.pixels.size(); ++i) {
            apart = std::max(apart, std::abs(with.pixels[i].b - without.pixels[i].b));
            changed = std::max(changed, std::abs(with.pixels[i].r - without.pixels[i].r));
        }
        EXPECT_LE(apart, 1e-6f) << method;
        EXPECT_GT(changed, 0.1f) << method;
    }
}

// Only the ratios count, and what is alike in all channels is drawn once, to the same bits.
TEST_F(ExtinctionColourTest, GreyIsAsWhite) {
    Scene scene = cloudScene();
    scene.render.method = "slabs";
    scene.medium.extinction_colour = glm::vec3(1);
    const Picture white = render(device(), scene, kOutside, kWidth, kHeight);
    for (const float grey : {0.25f, 0.0f}) {
        scene.medium.extinction_colour = glm::vec3(grey);
        EXPECT_EQ(render(device(), scene, kOutside, kWidth, kHeight).pixels, white.pixels) << grey;
    }
}

// A renderer that has drawn a medium of three hues draws what comes after as a fresh one does.
TEST_F(ExtinctionColourTest, NothingIsLeftOfHuesThatWere) {
    BRUME_WHOLE_LAYER_ONLY();
    for (const char* method : {"tiles", "slabs", "grid"}) {
        Scene scene = cloudScene();
        scene.render.method = method;
        scene.render.grid.spacing = 0.5f;
        Stage stage(device(), scene, kPlainCapacity);
        for (const glm::vec3 colour : {glm::vec3(1, 1, 0.1f), glm::vec3(1), glm::vec3(0.2f, 1, 1), glm::vec3(1)}) {
            scene.medium.extinction_colour = colour;
            EXPECT_EQ(stage.see(scene, kOutside, kWidth, kHeight).pixels,
                      render(device(), scene, kOutside, kWidth, kHeight).pixels)
                << method << ' ' << colour.x << ' ' << colour.z;
        }
    }
}

// Several eyes in one submission, of which each has the picture that it has alone. Planes are R, G, B.
TEST_F(ExtinctionColourTest, PicturesOfSeveralEyes) {
    BRUME_WHOLE_LAYER_ONLY();
    for (const bool objects : {false, true})
        for (const char* method : {"slabs", "tiles"}) {
            Scene scene = cloudScene();
            scene.render.method = method;
            scene.render.rate = 4;
            if (objects) addObjects(scene);
            const Simulation simulation(scene);
            Renderer renderer(device(), scene, simulation.capacity());
            Submission submission(device(), "eyes");
            const auto bytesOf = [](const PictureView& view) {
                return std::vector<uint8_t>(view.bytes, view.bytes + view.layout.bytes());
            };
            const EyeRequest eyes[]{{kOutside, 161, 91}, {kInside, 64, 36}, {kOutside, 96, 64}};
            submitAndWait(renderer, submission, simulation, eyes);
            std::vector<std::vector<uint8_t>> together;
            for (const PictureView& view : submission.pictures()) {
                EXPECT_TRUE(view.layout.full);
                together.push_back(bytesOf(view));
            }
            for (size_t i = 0; i < std::size(eyes); ++i) {
                submitAndWait(renderer, submission, simulation, {&eyes[i], 1});
                EXPECT_EQ(bytesOf(submission.pictures()[0]), together[i]) << method << ' ' << objects << ' ' << i;
            }
        }
}

TEST_F(ExtinctionColourTest, ProbedPixelsAreThoseOfThePicture) {
    for (const char* method : {"slabs", "tiles"}) {
        Scene scene = cloudScene();
        scene.render.method = method;
        scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0)};
        const Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        renderer.keepRadiance(true);
        Submission submission(device(), "probe");
        for (uint32_t i = 0; i < 64; ++i) submission.probe.pixels.emplace_back(i * 37 % kWidth, i * 23 % kHeight);
        const EyeRequest eye{kOutside, kWidth, kHeight};
        submitAndWait(renderer, submission, simulation, {&eye, 1});
        const std::vector<glm::vec4> picture = renderer.readRadiance();
        const std::span<const glm::vec4> values = submission.probe.values();
        float most = 0;
        for (size_t i = 0; i < values.size(); ++i) {
            const glm::uvec2 at = submission.probe.pixels[i];
            const glm::vec4 apart = glm::abs(values[i] - picture[at.y * kWidth + at.x]);
            most = std::max({most, apart.r, apart.g, apart.b, apart.a});
        }
        EXPECT_LT(most, 2e-5f) << method;
    }
}

} // namespace
} // namespace brume::test::extinction_colour_test
