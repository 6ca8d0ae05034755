// Sheets of glass: where rays meet them, and what they mirror.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "shaders/shared/glass.h"

namespace brume {
namespace {

using Vec = glm::dvec3;

class Numbers {
public:
    double in(double lo, double hi) { return std::uniform_real_distribution(lo, hi)(random_); }
    double logIn(double lo, double hi) { return std::exp(in(std::log(lo), std::log(hi))); }
    Vec inCube(double half) { return {in(-half, half), in(-half, half), in(-half, half)}; }
    Vec unit() { return glm::normalize(inCube(1) + 1e-9); }

private:
    std::mt19937 random_{3};
};

// A sheet, and its axes as lengths.
struct Sheet {
    Vec centre, across, along, normal; // m; across, along: half sides

    explicit Sheet(Numbers& numbers) : centre(numbers.inCube(30)), normal(numbers.unit()) {
        across = glm::normalize(glm::cross(normal, numbers.unit())) * numbers.logIn(0.05, 50);
        along = glm::normalize(glm::cross(normal, across)) * numbers.logIn(0.05, 50);
    }
    Vec at(double u, double v) const { return centre + u * across + v * along; }
    double meets(Vec origin, Vec dir) const {
        return physics::glassAt<double>(centre - origin, across / glm::dot(across, across),
                                        along / glm::dot(along, along), normal, dir);
    }
    float meetsInFloat(Vec origin, Vec dir) const {
        return physics::glassAt<float>(centre - origin, across / glm::dot(across, across),
                                       along / glm::dot(along, along), normal, dir);
    }
};

TEST(GlassAt, FindsPointsOfTheSheet) {
    Numbers numbers;
    for (int i = 0; i < 20000; ++i) {
        const Sheet sheet(numbers);
        const Vec origin = numbers.inCube(40), on = sheet.at(numbers.in(-0.999, 0.999), numbers.in(-0.999, 0.999));
        const double t = numbers.logIn(0.1, 100);
        const Vec dir = (on - origin) / t;
        if (std::abs(glm::dot(dir, sheet.normal)) < 1e-3 * glm::length(dir)) continue;
        EXPECT_NEAR(sheet.meets(origin, dir), t, 1e-8 * t) << i;
        EXPECT_EQ(sheet.meets(origin, -dir), -1) << "behind the origin";
    }
}

TEST(GlassAt, MissesBesideTheSheet) {
    Numbers numbers;
    for (int i = 0; i < 20000; ++i) {
        const Sheet sheet(numbers);
        const Vec origin = numbers.inCube(40);
        const double beside = numbers.in(0, 1) < 0.5 ? -1.001 : 1.001, free = numbers.in(-3, 3);
        const Vec on = i % 2 ? sheet.at(beside, free) : sheet.at(free, beside), dir = on - origin;
        if (std::abs(glm::dot(dir, sheet.normal)) < 1e-3 * glm::length(dir)) continue;
        EXPECT_EQ(sheet.meets(origin, dir), -1) << i;
    }
}

TEST(GlassAt, RaysInTheSheetsPlaneMissIt) {
    EXPECT_EQ(physics::glassAt<double>({0, 0, -5}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, -1}), -1);
    EXPECT_EQ(physics::glassAt<double>({0, 1, -5}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, -1}), -1);
    EXPECT_EQ(physics::glassAt<float>({0, 0, -5}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, -1}), -1);
}

// In float32 a ray near the plane may miss a sheet that it meets, but never gets a number that is none.
TEST(GlassAt, GrazingInFloat) {
    Numbers numbers;
    int met = 0;
    for (int i = 0; i < 100000; ++i) {
        const Sheet sheet(numbers);
        const double off = numbers.in(-1, 1) * numbers.logIn(1e-12, 1e-2);
        const Vec origin = sheet.at(numbers.in(-5, 5), numbers.in(-5, 5)) + off * sheet.normal;
        const Vec on = sheet.at(numbers.in(-0.9, 0.9), numbers.in(-0.9, 0.9));
        const float t = sheet.meetsInFloat(origin, on - origin);
        EXPECT_TRUE(std::isfinite(t) && (t > 0 || t == -1)) << t;
        met += t > 0;
    }
    EXPECT_GT(met, 10000);
}

TEST(GlassMirrors, SchlicksLaw) {
    for (const double straight : {0.02, 0.04, 0.5, 1.0}) {
        EXPECT_DOUBLE_EQ(physics::glassMirrors(straight, 1.0), straight);
        EXPECT_DOUBLE_EQ(physics::glassMirrors(straight, -1.0), straight) << "from behind";
        EXPECT_DOUBLE_EQ(physics::glassMirrors(straight, 0.0), 1) << "grazing";
        double before = straight;
        for (double cosine = 1; cosine >= 0; cosine -= 0.01) {
            const double mirrors = physics::glassMirrors(straight, cosine);
            EXPECT_NEAR(mirrors, straight + (1 - straight) * std::pow(1 - cosine, 5), 1e-14);
            EXPECT_GE(mirrors, before - 1e-15);
            before = mirrors;
        }
    }
    for (const double cosine : {0.0, 0.3, 1.0}) EXPECT_EQ(physics::glassMirrors(0.0, cosine), 0);
    EXPECT_EQ(physics::glassMirrors(0.04f, 1 + 1e-7f), 0.04f);
}

// Glass (index 1.5) by Fresnel's equations, which Schlick's law is known to meet within 0.02 up to 60 degrees.
TEST(GlassMirrors, IsNearFresnel) {
    for (double angle = 0; angle < 1.05; angle += 0.05) {
        const double c = std::cos(angle), in = std::sqrt(1 - std::pow(std::sin(angle) / 1.5, 2));
        const double s = (c - 1.5 * in) / (c + 1.5 * in), p = (1.5 * c - in) / (1.5 * c + in);
        EXPECT_NEAR(physics::glassMirrors(0.04, c), (s * s + p * p) / 2, 0.02) << angle;
    }
}

} // namespace
} // namespace brume
