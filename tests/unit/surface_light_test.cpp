// Closed forms of parts of surfaces: shaders/shared/surface_light.h.
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "shaders/shared/surface_light.h"

namespace brume::physics {
namespace {

constexpr double kPi = 3.141592653589793;

// Of a sphere under the half angle a: solid angle 2 pi (1 - cos a), and pi sin^2 a of it weighted by the cosine.
TEST(SurfaceLight, DirectionsOfAConeHaveItsSolidAngleAndItsFlux) {
    for (const double part : {1e-6, 0.1, 0.5, 0.9, 1.0}) {
        const double edge = sphereEdge(part);
        EXPECT_NEAR(edge, part < 1e-3 ? 0.5 * part * part : 1 - std::sqrt(1 - part * part), 1e-9 * edge + 1e-16);
        for (const int parts : {2, 4, 16}) {
            glm::dvec3 sum(0);
            for (int i = 0; i < parts * parts; ++i) {
                const glm::dvec3 w = coneDirection(i, parts, edge);
                EXPECT_NEAR(glm::length(w), 1, 1e-12);
                EXPECT_GE(w.z, 1 - edge - 1e-12);
                sum += w * (2 * kPi * edge / (parts * parts));
            }
            EXPECT_NEAR(sum.z, kPi * part * part, 1e-9 * part * part) << part;
            EXPECT_LT(std::hypot(sum.x, sum.y), 1e-12 * part) << part << ' ' << parts; // as much on every side
        }
        EXPECT_EQ(coneDirection(0, 1, edge), glm::dvec3(0, 0, 1));
    }
}

TEST(SurfaceLight, PartsOfAFaceAreSeenUnderEqualAngles) {
    for (const double height : {1e-6, 0.3, 50.0})
        for (const auto& [lo, hi] : {std::pair{-1.0, 1.0}, {-500.0, 500.0}, {2.0, 3.0}}) {
            EXPECT_EQ(evenAngle(0.0, 4.0, lo, hi, height), lo);
            EXPECT_EQ(evenAngle(4.0, 4.0, lo, hi, height), hi);
            for (int i = 0; i < 4; ++i) {
                const double from = evenAngle(double(i), 4.0, lo, hi, height),
                             to = evenAngle(i + 1.0, 4.0, lo, hi, height);
                EXPECT_NEAR(std::atan(to / height) - std::atan(from / height),
                            (std::atan(hi / height) - std::atan(lo / height)) / 4, 1e-9);
            }
        }
    EXPECT_NEAR(evenAngle(2.0, 4.0, 1.0, 1.001, 100.0), 1.0005, 1e-6); // far away: in the middle
}

TEST(SurfaceLight, RectanglesHaveTheirSolidAngles) {
    EXPECT_NEAR(rectangleSolidAngle(-1.0, -1.0, 1.0, 1.0, 1.0), 4 * kPi / 6, 1e-12); // a face of a cube from its middle
    EXPECT_NEAR(rectangleSolidAngle(-1e9, -1e9, 1e9, 1e9, 1.0), 2 * kPi, 1e-6);
    EXPECT_NEAR(rectangleSolidAngle(3.0, 4.0, 3.001, 4.002, 2.0),
                2e-6 * 2 / std::pow(3.0005 * 3.0005 + 4.001 * 4.001 + 4, 1.5), 1e-14);
    // As an area from where its sides are 0.0447 of the distance, with an error of 1e-3 of it.
    const auto square = [](double z) { return rectangleSolidAngle(-0.5, -0.5, 0.5, 0.5, z); };
    EXPECT_NEAR(square(31.7) / square(31.6), 31.6 * 31.6 / (31.7 * 31.7), 2e-3);
    EXPECT_NEAR(rectangleSolidAngle(-1.0, -1.0, 1.0, 1.0, 1e-9), 2 * kPi, 1e-6); // on it
    EXPECT_NEAR(rectangleSolidAngle(2.0, -1.0, 3.0, 1.0, 1e-9), 0, 1e-6);        // beside it
    double sum = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) sum += rectangleSolidAngle(-1 + 0.5 * i, 2.0 * j, -0.5 + 0.5 * i, 2.0 * j + 2, 0.7);
    EXPECT_NEAR(sum, rectangleSolidAngle(-1.0, 0.0, 1.0, 8.0, 0.7), 1e-12);
}

TEST(SurfaceLight, Float32SurvivesNearAndFar) {
    for (const float z : {1e-30f, 1e-6f, 1.0f, 1e6f})
        for (const float x : {0.0f, 1e-6f, 1.0f, 1e6f}) {
            const float between = evenAngle(1.0f, 4.0f, -x, 2 * x, z);
            EXPECT_TRUE(between >= -x && between <= 2 * x) << z << ' ' << x;
            const float angle = rectangleSolidAngle(-x, -1.0f, x, 1.0f, z);
            EXPECT_TRUE(angle >= 0 && angle < 6.2832f) << z << ' ' << x;
            EXPECT_NEAR(angle, rectangleSolidAngle(-double(x), -1.0, double(x), 1.0, double(z)), 2e-6) << z << ' ' << x;
        }
    for (const float far : {250.0f, 6250.0f, 1e6f}) // not more than it has
        EXPECT_NEAR(rectangleSolidAngle(far, far, far + 0.25f, far + 0.25f, far) * far * far, 0.0625 / std::pow(3, 1.5),
                    1e-3);
    for (const float part : {0.0f, 1e-20f, 1e-4f, 0.3f, 0.9999f, 1.0f})
        for (int i = 0; i < 16; ++i) {
            const glm::vec3 w = coneDirection(i, 4, sphereEdge(part));
            EXPECT_NEAR(glm::length(w), 1, 1e-6) << part;
        }
}

} // namespace
} // namespace brume::physics
