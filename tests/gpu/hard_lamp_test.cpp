// Points and spots where formulas are singular or cancel, against the double-precision reference.
#include <gtest/gtest.h>

#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::hard_lamp_test {
namespace {

constexpr double kInSmoke = 1e-2;

class HardLampTest : public JudgedTest {
protected:
    // Dark, but for lamps.
    static Scene dark(Scene scene) {
        scene.lights.clear();
        scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
        scene.render.method = "slabs";
        scene.render.rate = 1;
        scene.render.slabs = 128;
        return scene;
    }
    static Scene foggy() {
        Scene scene;
        scene.medium.layout = Layout::none;
        scene.fogs = {{.extinction = 0.05f, .albedo = {0.9f, 0.8f, 0.7f}}};
        return dark(scene);
    }
    static Light lamp(glm::vec3 position) { return {.type = kPoint, .position = position, .intensity = {90, 80, 60}}; }
};

const Pose kOutside = lookAt({2, 3, 14}, {0, 0, 0}, 0.9f);

TEST_F(HardLampTest, InTheMiddleOfAParticle) {
    Scene scene = dark(sceneOf({{.centre = {0.3f, 0.2f, 0}, .scale = 8, .sigma_t = 0.3f}}));
    scene.render.grid.spacing = 0.25f; // with 0.5 the lamp's own pixel is 2 % off
    scene.lights = {lamp({0.3f, 0.2f, 0})};
    judge(scene, {kOutside, lookAt({0.5f, 0.2f, 1}, {0, 0, 0}, 1.0f)}, kInSmoke);
}

TEST_F(HardLampTest, BehindTheEye) {
    Scene scene = foggy();
    scene.lights = {lamp({0, 0, 1})};
    judge(scene, {lookAt({0, 0, 0}, {0, 0, -5}, 1.0f), lookAt({0, 0, 0.999f}, {0, 0, -5}, 1.0f)});
}

TEST_F(HardLampTest, TheEyeInTheTipOfACone) {
    Scene scene = foggy();
    scene.lights = {lamp({0, 0, 0})};
    scene.lights[0].type = kSpot;
    scene.lights[0].axis = {0, 0, -1};
    scene.lights[0].inner = 0.2f, scene.lights[0].outer = 0.4f;
    judge(scene, {lookAt({0, 0, 0}, {0, 0, -5}, 1.0f), lookAt({0, 0, 0}, {1, 0.3f, -2}, 1.0f)});
}

TEST_F(HardLampTest, InFogToTheHorizon) {
    Scene scene = foggy();
    scene.fogs = {{.extinction = 0.02f, .falloff = 0.05f}};
    scene.planes = {{0, glm::vec3(0.3f)}};
    scene.lights = {lamp({0, 4, 0}), lamp({300, 20, -2000})};
    scene.lights[1].intensity = glm::vec3(1e6f);
    judge(scene, {lookAt({0, 2, 14}, {0, 2.2f, -1000}, 1.2f), lookAt({0, 300, 14}, {0, 0, -1000}, 1.2f)});
}

TEST_F(HardLampTest, OnAWall) {
    Scene scene = foggy();
    scene.boxes = {{{0, 0, -1}, {8, 8, 2}, 0, glm::vec3(0.5f)}};
    scene.lights = {lamp({1, 1, 0.001f})};
    judge(scene, {kOutside});
}

TEST_F(HardLampTest, OfAlmostNoRange) {
    Scene scene = foggy();
    scene.lights = {lamp({1, 1, 0}), lamp({-3, 0, 0})};
    scene.lights[0].range = 1e-3f;
    judge(scene, {kOutside});
}

// 1,023 of 1,024 lights are too weak to be seen: the picture is that of one.
TEST_F(HardLampTest, OneOf1024) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = foggy();
    scene.lights = {lamp({1, 1, 0})};
    judge(scene, {kOutside});
    const Picture one = render(device(), scene, kOutside, kWidth, kHeight);
    for (int i = 1; i < 1024; ++i) {
        Light weak = lamp({float(i % 32) - 16, float(i / 32) / 4 - 4, -2});
        weak.intensity *= 1e-9f;
        scene.lights.push_back(weak);
    }
    const Picture all = render(device(), scene, kOutside, kWidth, kHeight);
    double errors = 0, values = 0;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const glm::dvec3 a(one.at(x, y)), b(all.at(x, y));
            errors += glm::dot(a - b, a - b), values += glm::dot(a, a);
        }
    EXPECT_LE(std::sqrt(errors / values), 1e-4);
}

} // namespace
} // namespace brume::test::hard_lamp_test
