// Fog, drawn by the methods that draw it, against the double-precision reference: what it hides, what it scatters, with
// particles, objects and the eye in it, above it and below it.
#include <gtest/gtest.h>

#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::fog_test {
namespace {

// With rays two pixels apart, where balls' edges are a large part of a small picture: what the plan predicts of edges,
// 0.5 * 2 / sqrt(pixels) (fogError() of server/methods/rays/ray_plan.h).
constexpr double kEdges = 8.4e-3;

class FogTest : public JudgedTest {
protected:
    // A small cloud above the ground, lit from the side.
    static Scene cloudScene() {
        Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 0.35f), 1.6f);
        scene.lights[0].to_light = glm::normalize(glm::vec3(0.7f, 0.5f, 0.3f));
        scene.lights[0].irradiance = {12, 11, 9};
        scene.medium.anisotropy = 0.7f;
        scene.medium.asymmetry = 0.5f;
        scene.sky = {.zenith = {0.2f, 0.35f, 0.6f}, .horizon = {0.6f, 0.65f, 0.7f}};
        scene.render.rate = 2;
        scene.render.slabs = 128;
        scene.render.shadow_size = 256;
        scene.render.shadow_slices = 65;
        return scene;
    }
    static Scene withoutCloud() {
        Scene scene = cloudScene();
        scene.medium.layout = Layout::none;
        return scene;
    }
};

const Pose kOutside = lookAt({2, 3, 14}, {0, 0, 0}, 0.9f), kInside = lookAt({0.5f, 0.3f, 1}, {0, 0, -5}, 1.0f),
           kBelow = lookAt({3, -3.5f, 9}, {0, 1, 0}, 0.9f), kAbove = lookAt({4, 25, 18}, {0, 0, 0}, 0.2f),
           kHorizon = lookAt({0, 2, 14}, {0, 2.2f, -1000}, 1.2f);

TEST_F(FogTest, Homogeneous) {
    Scene scene = cloudScene();
    scene.fogs = {{.extinction = 0.05f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.fogs[0].hi = 30; // light reaches it
    judge(scene, {kOutside, kInside, kAbove});
}

TEST_F(FogTest, HeightFog) {
    Scene scene = cloudScene();
    scene.fogs = {{.extinction = 0.08f, .height = -2, .falloff = 0.3f, .albedo = {0.95f, 0.95f, 0.9f}}};
    scene.fogs[0].phase = "droplets";
    judge(scene, {kOutside, kInside, kBelow, kAbove, kHorizon});
}

TEST_F(FogTest, OverTheGroundToTheHorizon) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = cloudScene();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.fogs = {{.extinction = 0.05f, .height = -4, .falloff = 0.2f}};
    judge(scene, {kOutside, kInside, kBelow, kAbove, kHorizon});
}

TEST_F(FogTest, ALayerOnTheGround) {
    Scene scene = cloudScene();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.fogs = {{.extinction = 0.4f, .hi = -2.5f}};
    judge(scene, {kOutside, kBelow, kAbove, kHorizon});
}

TEST_F(FogTest, ABallAroundAndABallBeside) {
    Scene scene = cloudScene();
    scene.fogs = {{.extinction = 0.2f, .centre = {-1, 0, 1}, .radius = 3},
                  {.extinction = 2, .centre = {4, 2, -3}, .radius = 1.5f, .albedo = {0.9f, 0.4f, 0.2f}}};
    judge(scene, {kOutside, kInside, kBelow}, kEdges);
}

TEST_F(FogTest, FogsOfDifferentPhaseThatEmit) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = cloudScene();
    scene.sky.ambient = {0.1f, 0.15f, 0.2f};
    scene.fogs = {
        {.extinction = 0.04f, .falloff = 0.1f},
        {.extinction = 0.5f, .centre = {3, 0, 0}, .radius = 2, .albedo = {0.5f, 0.5f, 0.5f}, .emission = {3, 1, 0}}};
    scene.fogs[0].anisotropy = 1;
    scene.fogs[0].asymmetry = 0.7f;
    judge(scene, {kOutside, kInside, kBelow});
}

TEST_F(FogTest, ShaftsOfObjects) {
    Scene scene = cloudScene();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.boxes = {{{5, -1, 0}, {1, 6, 3}, 0.4f, glm::vec3(0.6f)}, {{-4, -3, 3}, {2, 2, 2}, 0, glm::vec3(0.3f)}};
    scene.spheres = {{{2, 4, 1}, 1.2f, glm::vec3(0.5f)}};
    scene.fogs = {{.extinction = 0.05f, .height = -4, .falloff = 0.1f}};
    judge(scene, {kOutside, kBelow, kAbove});
}

TEST_F(FogTest, WithoutParticles) {
    Scene scene = withoutCloud();
    scene.fogs = {{.extinction = 0.05f, .height = -2, .falloff = 0.3f},
                  {.extinction = 0.5f, .centre = {3, 0, 0}, .radius = 2, .albedo = {0.5f, 0.5f, 0.5f}}};
    judge(scene, {kOutside, kInside, kBelow, kHorizon});
}

// One that is lit past itself needs no slabs, and two are exact, too, where their extinctions fall at different rates.
TEST_F(FogTest, HeightFogsAlone) {
    Scene scene = withoutCloud();
    scene.fogs = {{.extinction = 0.05f, .height = -2, .falloff = 0.3f}};
    judge(scene, {kOutside, kInside, kBelow, kHorizon}, 2e-4);
    scene.fogs.push_back({.extinction = 0.05f, .height = -2, .falloff = 0.2f});
    judge(scene, {kOutside, kInside, kBelow, kHorizon}, 2e-4);
}

TEST_F(FogTest, OtherMethodsRefuseIt) {
    Scene scene = cloudScene();
    scene.fogs.emplace_back();
    const std::string others = "; use slabs, grid, froxels, lit, gradients or march";
    for (const auto& [method, lacks] : {std::pair("tiles", "no fog, no meshes, and no light of points and spots"),
                                        std::pair("sphere", "no fog, no meshes, and no light of points and spots"),
                                        std::pair("isv", "no fog and no meshes")}) {
        scene.render.method = method;
        try {
            render(device(), scene, kOutside, kWidth, kHeight);
            ADD_FAILURE() << method << " drew it";
        } catch (const gpu::Error& error) {
            EXPECT_EQ(error.what(), std::string(method) + ": it draws " + lacks + others);
        }
    }
}

// Without a sun nothing throws its shadow. Boxes still hide the fog behind them, between the corners of tiles too.
TEST_F(FogTest, BoxesWithoutASun) {
    Scene scene = withoutCloud();
    scene.lights[0].irradiance = glm::vec3(0);
    scene.sky.ambient = glm::vec3(0.2f);
    scene.fogs = {{.extinction = 0.05f, .height = -2, .falloff = 0.3f}, {.extinction = 0.02f}};
    for (const float x : {-3.0f, 0.0f, 3.0f})
        for (const float y : {-1.5f, 0.5f, 2.5f})
            scene.boxes.push_back({{x, y, 4}, glm::vec3(0.7f), 0, glm::vec3(0.1f)});
    scene.render.rate = 8;
    judge(scene, {kOutside});
}

// A room with an opening: nearly all of every ray is in shadow, whose boundaries lie far apart.
TEST_F(FogTest, LightThroughAWindow) {
    Scene scene = withoutCloud();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    const glm::vec3 grey(0.5f);
    scene.boxes = {{{0, 3, 0}, {17, 0.4f, 17}, 0, grey},      {{0, -0.5f, -8}, {17, 7, 0.4f}, 0, grey},
                   {{-8, -0.5f, 0}, {0.4f, 7, 17}, 0, grey},  {{8, -3, 0}, {0.4f, 2, 17}, 0, grey},
                   {{8, 2, 0}, {0.4f, 2, 17}, 0, grey},       {{8, -0.5f, -5}, {0.4f, 3, 7}, 0, grey},
                   {{8, -0.5f, 5.5f}, {0.4f, 3, 6}, 0, grey}, {{0, -0.5f, 8}, {17, 7, 0.4f}, 0, grey}};
    scene.fogs = {{.extinction = 0.05f, .hi = 3}};
    const Pose inside = lookAt({-6, 1, 6}, {3, -2, -3}, 1.0f);
    judge(scene, {inside});
    for (Box& box : scene.boxes) box.albedo = glm::vec3(0); // nothing is seen but the shaft
    scene.planes[0].albedo = glm::vec3(0);
    judge(scene, {inside}, 1e-3);
    scene.fogs.push_back({.extinction = 0.03f, .falloff = 0.4f, .hi = 3, .albedo = {0.5f, 0.6f, 0.7f}});
    judge(scene, {inside}, 1.5e-2); // of the shaft, whose light is looked up between rays
}

// The light of one fog is each pixel's own, however far apart rays are: also beside things so close to the eye that
// what casts the shadow is behind them.
TEST_F(FogTest, ShadowsBesideSomethingCloseAreThoseOfEveryRate) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = withoutCloud();
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.8f, 0.5f, 0.1f));
    scene.fogs = {{.extinction = 0.03f, .falloff = 0.02f}};
    const glm::vec3 grey(0.5f);
    scene.boxes = {{{8, 10, -20}, {1, 12, 14}, 0, grey},
                   {{-0.4f, 1, 7}, {0.5f, 6, 0.1f}, 0, grey},
                   {{0.6f, 1, 7}, {0.45f, 6, 0.1f}, 0, grey}};
    scene.render.method = "slabs";
    scene.render.shading = 1; // shafts at every pixel
    Stage stage(device(), scene, 1);
    std::vector<Picture> pictures;
    for (const uint32_t rate : {1u, 2u, 3u, 4u, 8u}) {
        scene.render.rate = rate;
        pictures.push_back(stage.see(scene, lookAt({0, 3, 10}, {0, 4, -10}, 0.9f), 320, 180));
        EXPECT_TRUE(pictures.back().pixels == pictures.front().pixels) << rate;
    }
}

} // namespace
} // namespace brume::test::fog_test
