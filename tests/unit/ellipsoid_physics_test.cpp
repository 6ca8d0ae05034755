// shaders/shared/ellipsoid.h against sums in double over the Gaussian itself.
#include "shaders/shared/ellipsoid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "shaders/shared/transmittance.h"

namespace brume::ellipsoid_physics_test {
namespace {

using glm::dvec3;

struct Axes {
    dvec3 a, b, c;
};

// Semi-axes of these lengths, turned by chance.
Axes turnedAxes(dvec3 lengths, std::mt19937& random) {
    std::normal_distribution<double> normal;
    const auto vector = [&] { return glm::normalize(dvec3(normal(random), normal(random), normal(random))); };
    const dvec3 a = vector(), b = glm::normalize(glm::cross(a, vector()));
    return {lengths.x * a, lengths.y * b, lengths.z * glm::cross(a, b)};
}

// exp(-x^2 / 2) at `x` of the Gaussian with deviation s along the longest semi-axis.
double gaussian(const Axes& axes, double s, dvec3 x) {
    const dvec3 y = physics::inSemiAxes(x, axes.a, axes.b, axes.c) / s;
    return std::exp(-0.5 * glm::dot(y, y));
}

double sliced(const physics::SlicedGaussian<double>& cut, dvec3 x) {
    const double det = cut.xx * cut.yy - cut.xy * cut.xy, z = x.z - cut.tilt_x * x.x - cut.tilt_y * x.y;
    const double across = (cut.yy * x.x * x.x - 2 * cut.xy * x.x * x.y + cut.xx * x.y * x.y) / det;
    return std::exp(-0.5 * across - 0.5 * z * z / cut.along);
}

const dvec3 kShapes[] = {{1, 1, 1}, {1, 0.5, 0.25}, {1, 1, 0.01}, {1, 0.01, 0.01}, {0.03, 1, 0.3}};

TEST(Ellipsoid, OnALineIsABall) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (const dvec3 shape : kShapes) {
        for (int i = 0; i < 20; ++i) {
            const Axes axes = turnedAxes(shape, random);
            const double k = std::sqrt(50.0) / 1.6, s = 1 / (std::sqrt(2.0) * k);
            const dvec3 to(3 + normal(random), normal(random), normal(random)),
                w = glm::normalize(to + 0.3 * s * dvec3(normal(random), normal(random), normal(random)));
            const auto ball = physics::ballOnLine(to, w, k, axes.a, axes.b, axes.c);
            for (int step = -8; step <= 8; ++step) {
                const double t = ball.closest + 0.25 * step / ball.k, q = ball.k * (t - ball.closest);
                EXPECT_NEAR(gaussian(axes, s, t * w - to), physics::gaussianAcross(ball.k, ball.b2) * std::exp(-q * q),
                            1e-11);
            }
        }
    }
}

TEST(Ellipsoid, OfEqualAxesIsTheBallThatItIs) {
    std::mt19937 random(2);
    const Axes axes = turnedAxes({1, 1, 1}, random);
    const dvec3 to(2, 3, 4), w = glm::normalize(dvec3(1, 2, 2));
    const auto ball = physics::ballOnLine(to, w, 3.0, axes.a, axes.b, axes.c);
    EXPECT_NEAR(ball.k, 3, 1e-12);
    EXPECT_NEAR(ball.closest, glm::dot(to, w), 1e-12);
    EXPECT_NEAR(ball.b2, glm::dot(to, to) - ball.closest * ball.closest, 1e-12);
    const auto cut = physics::slicedGaussian(0.5, axes.a, axes.b, axes.c);
    EXPECT_NEAR(cut.xx, 0.25, 1e-12);
    EXPECT_NEAR(cut.yy, 0.25, 1e-12);
    EXPECT_NEAR(cut.along, 0.25, 1e-12);
    for (const double zero : {cut.xy, cut.tilt_x, cut.tilt_y}) EXPECT_NEAR(zero, 0, 1e-12);
}

TEST(Ellipsoid, SlicesAreThatGaussian) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (const dvec3 shape : kShapes)
        for (int i = 0; i < 20; ++i) {
            const Axes axes = turnedAxes(shape, random);
            const auto cut = physics::slicedGaussian(0.7, axes.a, axes.b, axes.c);
            EXPECT_NEAR(physics::acrossDeterminant(cut) * cut.along,
                        std::pow(0.7, 6) * std::pow(shape.x * shape.y * shape.z, 2), 1e-9);
            for (int j = 0; j < 20; ++j) { // points of the ellipsoid
                const dvec3 x = 0.7 * (normal(random) * axes.a + normal(random) * axes.b + normal(random) * axes.c);
                EXPECT_NEAR(sliced(cut, x), gaussian(axes, 0.7, x), 1e-7);
            }
        }
}

// The variances of a sliced Gaussian as a matrix: xx, xy, yy, xz, yz, zz.
std::array<double, 6> variances(const physics::SlicedGaussian<double>& cut) {
    const double xz = cut.xx * cut.tilt_x + cut.xy * cut.tilt_y, yz = cut.xy * cut.tilt_x + cut.yy * cut.tilt_y;
    return {cut.xx, cut.xy, cut.yy, xz, yz, physics::varianceAlong(cut)};
}

TEST(Ellipsoid, IsBlurredAcrossAloneAndNoMoreThanNeeded) {
    std::mt19937 random(4);
    int blurred = 0;
    for (const dvec3 shape : kShapes)
        for (int i = 0; i < 40; ++i) {
            const Axes axes = turnedAxes(shape, random);
            const auto cut = physics::slicedGaussian(1.0, axes.a, axes.b, axes.c);
            for (const double least : {0.0002, 0.04, 0.3, 2.0}) {
                const auto wide = physics::widenedAcross(cut, least);
                const auto before = variances(cut), after = variances(wide);
                for (const int kept : {3, 4, 5}) EXPECT_NEAR(before[kept], after[kept], 1e-9) << kept;
                const auto leastOf = [](const std::array<double, 6>& v) {
                    return 0.5 * (v[0] + v[2]) - std::hypot(0.5 * (v[0] - v[2]), v[1]);
                };
                if (leastOf(before) >= least) {
                    EXPECT_EQ(before, after);
                    continue;
                }
                ++blurred;
                EXPECT_NEAR(leastOf(after), least, 1e-9);
                // What was added has no more in any direction than what is missing there.
                const double most =
                    0.5 * (after[0] - before[0] + after[2] - before[2]) +
                    std::hypot(0.5 * (after[0] - before[0] - after[2] + before[2]), after[1] - before[1]);
                EXPECT_NEAR(most, least - leastOf(before), 1e-9);
                EXPECT_GE(wide.along, cut.along);
            }
        }
    EXPECT_GT(blurred, 200);
}

// float32 keeps what double has, for the flattest of them and from far away.
TEST(Ellipsoid, SurvivesFloat) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    double worst = 0;
    for (const dvec3 shape : kShapes)
        for (int i = 0; i < 200; ++i) {
            const Axes axes = turnedAxes(shape, random);
            const glm::vec3 a(axes.a), b(axes.b), c(axes.c);
            const double k = 4, s = 1 / (std::sqrt(2.0) * k);
            const dvec3 in = s * (normal(random) * axes.a + normal(random) * axes.b + normal(random) * axes.c);
            const dvec3 w = glm::normalize(dvec3(normal(random), normal(random), normal(random)));
            const glm::vec3 to(30.0 * w - in);
            const auto ball = physics::ballOnLine(to, glm::vec3(w), float(k), a, b, c);
            const auto exact = physics::ballOnLine(dvec3(to), dvec3(glm::vec3(w)), k, dvec3(a), dvec3(b), dvec3(c));
            const double depth = double(physics::lineDepth(1.0f, ball.k, physics::gaussianAcross(ball.k, ball.b2)));
            const double depth_exact = physics::lineDepth(1.0, exact.k, physics::gaussianAcross(exact.k, exact.b2));
            worst = std::max(worst, std::abs(depth - depth_exact) / physics::lineDepth(1.0, exact.k, 1.0));
        }
    EXPECT_LT(worst, 0.002); // at 120 radii of the longest axis, of ellipsoids a hundred times as thin
    EXPECT_GT(worst, 0);
}

} // namespace
} // namespace brume::ellipsoid_physics_test
