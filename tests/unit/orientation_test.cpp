// Rotations by chance for particles: even among all rotations, and each particle's own.
#include "shaders/shared/orientation.h"

#include <cmath>

#include <gtest/gtest.h>

namespace brume::orientation_test {
namespace {

TEST(Orientation, IsARotationOfItsOwn) {
    for (uint32_t i = 0; i < 1000; ++i) {
        const glm::vec4 q = gpu::orientationOf(i), next = gpu::orientationOf(i + 1);
        ASSERT_NEAR(glm::dot(q, q), 1, 1e-5f) << i;
        ASSERT_LT(std::abs(glm::dot(q, next)), 0.99999f) << i;
        const glm::vec3 x = gpu::turned(q, {1, 0, 0}), y = gpu::turned(q, {0, 1, 0}), z = gpu::turned(q, {0, 0, 1});
        ASSERT_LT(glm::distance(glm::cross(x, y), z), 1e-5f) << i;
        ASSERT_LT(glm::distance(gpu::turnedBack(q, x), glm::vec3(1, 0, 0)), 1e-5f) << i;
    }
}

// Of even rotations an axis is even on the sphere, and the square of each of the quaternion's numbers is 1/4 on
// average. Five standard deviations of the means of 20,000.
TEST(Orientation, IsEvenAmongAllRotations) {
    constexpr int kCount = 20000;
    glm::dvec3 mean(0), squares(0);
    glm::dvec4 of_quaternion(0), fourth(0);
    for (uint32_t i = 0; i < kCount; ++i) {
        const glm::dvec4 q(gpu::orientationOf(i));
        const glm::dvec3 axis(gpu::turned(glm::vec4(q), {0.6f, 0, 0.8f}));
        mean += axis / double(kCount), squares += axis * axis / double(kCount);
        of_quaternion += q * q / double(kCount), fourth += q * q * q * q / double(kCount);
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(mean[c], 0, 5 * std::sqrt(1.0 / 3 / kCount)) << c;
        EXPECT_NEAR(squares[c], 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kCount)) << c;
    }
    for (int c = 0; c < 4; ++c) {
        EXPECT_NEAR(of_quaternion[c], 0.25, 5 * std::sqrt(1.0 / 16 / kCount)) << c;
        EXPECT_NEAR(fourth[c], 0.125, 5 * std::sqrt(0.04 / kCount)) << c;
    }
}

} // namespace
} // namespace brume::orientation_test
