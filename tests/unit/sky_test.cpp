// The sky's light on surfaces against its integral.
#include <cmath>

#include <gtest/gtest.h>

#include "shaders/shared/sky.h"

namespace brume {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(Sky, LightsASurfaceAsItsIntegralSays) {
    constexpr int kSteps = 2000; // of the height of a direction
    for (double up = -1; up <= 1; up += 0.05) {
        double seen = 0, zenith = 0;
        for (int i = 0; i < kSteps; ++i) {
            // Integral of the cosine with the normal over all directions of one height, where it is positive.
            const double height = (i + 0.5) / kSteps, along = height * up;
            const double across = std::sqrt(std::max((1 - height * height) * (1 - up * up), 1e-300));
            const double angle = std::acos(std::clamp(-along / across, -1.0, 1.0));
            const double cosines = 2 * (angle * along + std::sin(angle) * across) / kPi / kSteps;
            seen += cosines, zenith += cosines * physics::skyZenithPart(height);
        }
        EXPECT_NEAR(physics::skySeen(up), seen, 1e-5) << up;
        EXPECT_NEAR(physics::skyZenithSeen(up), zenith, 0.0012) << up;
    }
}

TEST(Sky, BlendsFromTheHorizonToTheZenith) {
    EXPECT_EQ(physics::skyZenithPart(-0.15), 0);
    EXPECT_EQ(physics::skyZenithPart(-1.0), 0);
    EXPECT_NEAR(physics::skyZenithPart(0.35), 0.5, 1e-15);
    EXPECT_EQ(physics::skyZenithPart(0.85), 1);
    EXPECT_EQ(physics::skyZenithPart(1.0), 1);
}

} // namespace
} // namespace brume
