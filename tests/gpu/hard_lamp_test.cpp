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
        const int row = i / 32;
        Light weak = lamp({float(i % 32) - 16, float(row) / 4 - 4, -2});
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

// Each of 1,024 lamps is seen in each pixel: the picture is the sum of those of 32 lamps at a time. Light is added up
// in another order there, so that a pixel errs by some roundings of 1,024 sums; one lamp that is lost is 2e-4 of it.
TEST_F(HardLampTest, AllOf1024) {
    constexpr uint32_t kWide = 40, kHigh = 24, kLamps = 1024, kAtOnce = 32; // a word of the bins
    Scene scene = foggy();
    scene.sky.horizon = glm::vec3(0);
    scene.boxes = {{{0, 0, -8}, {200, 200, 2}, 0, glm::vec3(0)}}; // black: rays end there, whichever lamps there are
    std::vector<Light> lamps;
    for (uint32_t i = 0; i < kLamps; ++i) {
        Light one = lamp(glm::vec3(i % 16, i / 16 % 8, i / 128) * 0.1f);
        one.intensity = glm::vec3(1);
        one.shadows = false;
        lamps.push_back(one);
    }
    scene.render.march = {.samples = 16, .dither = "none", .blur = "none"};
    scene.render.froxels = {.pixels = 4, .slices = 32};
    for (const char* method : {"march", "froxels"}) {
        scene.render.method = method;
        Stage stage(device(), scene, 1);
        const auto seen = [&](size_t first, size_t count) {
            scene.lights.assign(lamps.begin() + std::ptrdiff_t(first), lamps.begin() + std::ptrdiff_t(first + count));
            return stage.see(scene, kOutside, kWide, kHigh);
        };
        const Picture all = seen(0, kLamps), but_one = seen(0, kLamps - 1);
        std::vector<double> sums(all.pixels.size());
        for (size_t first = 0; first < kLamps; first += kAtOnce) {
            const Picture some = seen(first, kAtOnce);
            for (size_t i = 0; i < sums.size(); ++i) sums[i] += double(some.pixels[i].r);
        }
        double worst = 0, least = 1; // of a pixel's light: the error; what the last lamp gives
        for (size_t i = 0; i < sums.size(); ++i) {
            worst = std::max(worst, std::abs(double(all.pixels[i].r) / sums[i] - 1));
            least = std::min(least, 1 - double(but_one.pixels[i].r) / sums[i]);
        }
        std::printf("%-7s off by %.1e, one lamp is %.1e\n", method, worst, least);
        EXPECT_LE(worst, 5e-5) << method;
        EXPECT_GT(least, 2e-4) << method << ": a lamp that is lost would not be seen";
    }
}

} // namespace
} // namespace brume::test::hard_lamp_test
