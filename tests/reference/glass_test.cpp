// The reference through sheets of glass, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "tools/reference/medium_reference.h"
#include "tools/reference/pixel.h"
#include "tools/reference/tracker.h"

namespace brume::reference::glass_test {
namespace {

constexpr double kSigma = 0.25, kHigh = 6, kAlbedo = 0.8, kAmbient = 2;
const glm::dvec3 kZenith{3, 2, 1}, kHorizon{0.5, 1, 2};
const Ray kDown{{0, 10, 0}, {0, -1, 0}};

// A layer of fog in even light, before the sky below it.
World layer() {
    World world;
    world.fogs = {{.sigma_t = kSigma, .albedo = glm::dvec3(kAlbedo), .lo = 0, .hi = kHigh}};
    world.ambient = glm::dvec3(kAmbient);
    world.sky_zenith = kZenith, world.sky_horizon = kHorizon;
    return world;
}

Sheet level(double height, glm::dvec3 transmittance, double reflectance) {
    return sheetOf({.centre = {0, height, 0},
                    .pitch = float(kPi / 2),
                    .transmittance = transmittance,
                    .reflectance = float(reflectance)});
}

double depthTo(double height, double sigma) { return sigma * std::max(kHigh - height, 0.0); }
double light(double depth) { return kAlbedo * kAmbient * -std::expm1(-depth); }

TEST(Glass, StandsAsItsAnglesSay) {
    const Sheet upright = sheetOf({.width = 4, .height = 2});
    EXPECT_LT(glm::distance(upright.normal, {0, 0, 1}), 1e-12);
    EXPECT_LT(glm::distance(upright.across, {0.5, 0, 0}), 1e-12);
    EXPECT_LT(glm::distance(upright.along, {0, 1, 0}), 1e-12);
    const Sheet turned = sheetOf({.yaw = float(kPi / 2)}), tipped = level(0, glm::dvec3(1), 0);
    EXPECT_LT(glm::distance(turned.normal, {1, 0, 0}), 1e-7);
    EXPECT_LT(glm::distance(turned.across, {0, 0, -1}), 1e-7);
    EXPECT_LT(glm::distance(tipped.normal, {0, -1, 0}), 1e-7);
}

// Two sheets in even fog. What is before, between and behind them is seen through none, one and both.
TEST(Glass, InALayerOfFog) {
    const glm::dvec3 upper(0.9, 0.5, 0.2), lower(0.3, 0.8, 1);
    for (const bool swapped : {false, true}) {
        World world = layer();
        world.sheets = {level(4, upper, 0.1), level(1.5, lower, 0.3)};
        if (swapped) std::swap(world.sheets[0], world.sheets[1]);
        const RayResult seen = along(world, kDown);
        const double first = depthTo(4, kSigma), second = depthTo(1.5, kSigma), all = depthTo(0, kSigma);
        for (int c = 0; c < 3; ++c) {
            const double t1 = 0.9 * double(float(upper[c])), t2 = 0.7 * double(float(lower[c]));
            const double expected = light(first) + std::exp(-first) * 0.1 * kZenith[c] +
                                    t1 * (light(second) - light(first) + std::exp(-second) * 0.3 * kZenith[c]) +
                                    t1 * t2 * (light(all) - light(second) + std::exp(-all) * kHorizon[c]);
            EXPECT_NEAR(seen.total()[c], expected, 3e-7) << c;
        }
        EXPECT_NEAR(seen.transmittance, std::exp(-all), 1e-9) << "of the medium alone";
    }
}

TEST(Glass, InAColouredMedium) {
    World world = layer();
    world.fogs[0].extinction_colour = {1, 0.5, 0};
    world.sheets = {level(4, {0.9, 0.5, 0.2}, 0)};
    const RayResult seen = along(world, kDown);
    for (int c = 0; c < 3; ++c) {
        const double sigma = kSigma * world.fogs[0].extinction_colour[c],
                     t = double(float(glm::dvec3(0.9, 0.5, 0.2)[c]));
        const double first = depthTo(4, sigma), all = depthTo(0, sigma);
        EXPECT_NEAR(seen.total()[c], light(first) + t * (light(all) - light(first) + std::exp(-all) * kHorizon[c]),
                    3e-7)
            << c;
    }
}

// Behind a surface, behind the eye, beside the ray: no sheet is seen.
TEST(Glass, OutOfSight) {
    World world = layer(), bare = layer();
    world.obstacles = bare.obstacles = {{.kind = Obstacle::Kind::plane, .centre = {0, 2, 0}}};
    Sheet beside = level(4, glm::dvec3(0), 1);
    beside.centre.x = 1.001;
    world.sheets = {level(1, glm::dvec3(0), 1), level(11, glm::dvec3(0), 1), beside};
    const RayResult with = along(world, kDown), without = along(bare, kDown);
    EXPECT_NEAR(glm::distance(with.total(), without.total()), 0, 1e-9);
    EXPECT_TRUE(hasEdges(world) && !hasEdges(layer()));
}

// Random paths agree: the camera's rays alone meet glass.
TEST(Glass, RandomPathsAgree) {
    World world = layer();
    world.fogs[0].albedo = glm::dvec3(0);
    world.fogs[0].emission = glm::dvec3(1, 2, 3);
    world.sheets = {level(4, {0.9, 0.5, 0.2}, 0.1), level(1.5, {0.3, 0.8, 1}, 0.3)};
    const Pose pose = lookAt({0, 10, 0}, {0, 0, 0}, 0.1f);
    const Camera camera = perspective(pose, 3, 3);
    const TrackedPicture paths = track(world, camera, {.samples = 20000});
    const Picture exact = render(world, camera);
    for (size_t i = 0; i < paths.radiance.size(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(paths.radiance[i][c], exact.total()[i][c], 4.5 * paths.standard_error[i][c]) << i << ' ' << c;
}

TEST(Glass, NotInSequentialComposition) {
    World world;
    world.composition = Composition::sequential;
    world.sheets = {level(4, glm::dvec3(1), 0)};
    EXPECT_THROW(along(world, kDown), std::invalid_argument);
}

} // namespace
} // namespace brume::reference::glass_test
