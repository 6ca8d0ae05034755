// Method slabs: what coarse rays make of pixels between them.
#include <algorithm>
#include <cmath>

#include "tests/gpu/closed_form.h"

namespace brume::test {
namespace {

constexpr uint32_t kWidth = 101, kHeight = 67; // no multiple of anything

class SlabsTest : public GpuTest {
protected:
    static Scene soft() {
        Scene scene = sceneOf(randomPoints(60, 6, 9, 0.02f), 1.6f);
        scene.render.method = "slabs";
        scene.render.slabs = 32;
        scene.render.least_transmittance = 0;
        return scene;
    }
    // Relative RMSE of the optical depths that every `rate`th pixel's rays leave, against a ray for each.
    static double error(Stage& stage, Scene scene, uint32_t rate, const Pose& pose) {
        scene.render.rate = 1;
        const Picture fine = stage.see(scene, pose, kWidth, kHeight);
        scene.render.rate = rate;
        const Picture coarse = stage.see(scene, pose, kWidth, kHeight);
        double squares = 0, all = 0;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const double exact = -std::log(double(fine.at(x, y).a));
                squares += std::pow(-std::log(double(coarse.at(x, y).a)) - exact, 2);
                all += exact * exact;
            }
        EXPECT_GT(all, 0.01 * kWidth * kHeight);
        return std::sqrt(squares / all);
    }
};

constexpr double kDeviation = 0.1 * 9 * 1.6; // m
const Pose kPose = lookAt({3, 2, 34}, {0, 0, 0}, 0.35f);
double spacing(uint32_t rate) { return rate * 2 * std::tan(0.175) / kHeight * 34 / kDeviation; }

// A cubic B-spline through an isolated Gaussian errs by 0.013 q^4.5 along one axis for spacings q of 0.4 to 1 deviations; along
// two by half as much again. What the cut-off of the particles' far tails leaves is the rest.
TEST_F(SlabsTest, RaysOfEveryRateErrByTheirSpacing) {
    Stage stage(device(), soft(), 60);
    for (const uint32_t rate : {2u, 3u, 4u, 6u, 7u, 8u}) {
        const double q = spacing(rate);
        EXPECT_LT(error(stage, soft(), rate, kPose), 0.02 * std::pow(q, 4.5) + 3e-4) << rate << " pixels, " << q << " deviations";
    }
    EXPECT_GT(error(stage, soft(), 16, kPose), 0.01) << "rays too far apart are not seen by this test";
}

// Rays that end on a surface: a wall through the medium, all over the picture.
TEST_F(SlabsTest, RaysThatEndOnASurfaceErrNoMore) {
    Scene scene = soft();
    scene.boxes = {{{0, 0, -51}, {400, 400, 100}, 0.1f, glm::vec3(0)}};
    Stage stage(device(), scene, 60);
    for (const uint32_t rate : {2u, 4u, 6u, 7u}) {
        const double q = spacing(rate);
        EXPECT_LT(error(stage, scene, rate, kPose), 0.02 * std::pow(q, 4.5) + 5e-4) << rate << " pixels, " << q << " deviations";
    }
}

// At the rim of a medium rays that meet it lie beside rays that meet nothing: what is scattered there is a share of what there
// is, and all that reaches the light's map is lit.
TEST_F(SlabsTest, TheRimOfAThinMediumIsAsBrightAsItIsDense) {
    Scene scene = sceneOf({thick({0, 0, 0}, 9, 0.02, 1.6f)}, 1.6f);
    scene.render = soft().render;
    scene.lights[0].irradiance = glm::vec3(float(4 * kPi));
    Stage stage(device(), scene, 1);
    for (const uint32_t rate : {4u, 6u, 8u}) {
        scene.render.rate = rate;
        const Picture picture = stage.see(scene, lookAt({0, 0, 34}, {0, 0, 0}, 0.5f), kWidth, kHeight);
        double least = 1e30, most = 0;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const double opacity = 1 - double(picture.at(x, y).a);
                if (opacity < 1e-4) continue; // float32's own rounding counts below
                least = std::min(least, double(picture.at(x, y).r) / opacity);
                most = std::max(most, double(picture.at(x, y).r) / opacity);
            }
        // Its own shadow takes 2 % at most.
        EXPECT_GT(least, 0.975) << rate;
        EXPECT_LT(most, 1.005) << rate;
    }
}

} // namespace
} // namespace brume::test
