// The structure of a ground: its filter against numerical means, its waves, its footprint, and float far away.
#include <array>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "shaders/shared/ground.h"

namespace brume::ground_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

using Vec = glm::dvec3;

class Numbers {
public:
    double in(double lo, double hi) { return std::uniform_real_distribution(lo, hi)(random_); }
    double logIn(double lo, double hi) { return std::exp(in(std::log(lo), std::log(hi))); }
    Vec along(double length) {
        const double angle = in(0, 2 * kPi);
        return {length * std::cos(angle), 0, length * std::sin(angle)};
    }

private:
    std::mt19937 random_{3};
};

// Mean over a Gaussian with half axes a and b of the structure, which is filtered already over a footprint with half
// axes c and d. The trapezoidal rule is exact while no wave that is left turns by more than 12 on a half axis.
double numericalMean(Vec x, Vec a, Vec b, Vec c, Vec d, double size) {
    constexpr int kReach = 30;
    constexpr double kStep = 0.2;
    double sum = 0, weights = 0;
    for (int i = -kReach; i <= kReach; ++i)
        for (int j = -kReach; j <= kReach; ++j) {
            const double s = i * kStep, t = j * kStep, weight = std::exp(-(s * s + t * t) / 2);
            const Vec at = x + s * a + t * b;
            sum += weight * physics::groundStructure(at.x, at.z, c, d, size);
            weights += weight;
        }
    return sum / weights;
}

TEST(Ground, FilteredIsTheMeanOverTheFootprint) {
    Numbers numbers;
    double largest = 0;
    for (int i = 0; i < 60; ++i) {
        const double size = numbers.logIn(0.1, 100), longest = 0.04 * size; // where the shortest waves turn by 12
        const Vec x(numbers.in(-500, 500), 0, numbers.in(-500, 500));
        const Vec a = numbers.along(longest * numbers.logIn(0.05, 1)), b = numbers.along(longest * numbers.in(0, 1));
        const double exact = numericalMean(x, a, b, Vec(0), Vec(0), size);
        EXPECT_NEAR(physics::groundStructure(x.x, x.z, a, b, size), exact, 2e-6) << size;
        largest = std::max(largest, std::abs(exact - physics::groundStructure(x.x, x.z, Vec(0), Vec(0), size)));
    }
    EXPECT_GT(largest, 0.05) << "the footprints filter";
}

// At all lengths of the footprint: what is filtered over c and then over a is as filtered over both at once.
TEST(Ground, FilteredTwiceIsFilteredOverTheSum) {
    Numbers numbers;
    double largest = 0;
    for (int i = 0; i < 60; ++i) {
        const double size = numbers.logIn(0.1, 100), first = size * numbers.logIn(0.01, 0.3);
        const Vec x(numbers.in(-500, 500), 0, numbers.in(-500, 500));
        const Vec c = numbers.along(first), d(-c.z, 0, c.x), a = numbers.in(0, 2) * c, b = numbers.in(0, 2) * d;
        const double exact = numericalMean(x, a, b, c, d, size);
        const Vec both_a = c / first * std::hypot(first, glm::length(a)),
                  both_b = d / first * std::hypot(first, glm::length(b));
        EXPECT_NEAR(physics::groundStructure(x.x, x.z, both_a, both_b, size), exact, 1e-6) << size;
        largest = std::max(largest, std::abs(exact));
    }
    EXPECT_GT(largest, 0.1) << "there is something left to filter";
}

// It is a sum of twenty waves whose amplitudes are 1 together: |f| is at most 1.
TEST(Ground, AmplitudesAreOneTogether) {
    std::vector<std::array<double, 2>> waves{{63, 9}, {-12, 78}, {-75, 60}, {72, 92}};
    for (size_t i = 0; i < 16; ++i)
        waves.push_back({2 * waves[i][0] + waves[i][1], 2 * waves[i][1] - waves[i][0]}); // turned and shortened
    constexpr int kPlaces = 1 << 15; // lattice points over the period: enough to tell all waves apart
    std::vector<std::complex<double>> amplitudes(waves.size());
    double squares = 0;
    for (int i = 0; i < kPlaces; ++i) {
        const double u = double(i) / kPlaces, v = std::fmod(i * 12'345.0, kPlaces) / kPlaces;
        const double f = physics::groundStructure(64 * u, 64 * v, Vec(0), Vec(0), 1.0);
        squares += f * f / kPlaces;
        for (size_t w = 0; w < waves.size(); ++w)
            amplitudes[w] += 2 * f / kPlaces * std::polar(1.0, -2 * kPi * (waves[w][0] * u + waves[w][1] * v));
    }
    double sum = 0, of_waves = 0;
    for (const std::complex<double> amplitude : amplitudes)
        sum += std::abs(amplitude), of_waves += std::norm(amplitude) / 2;
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_LE(sum, 1);
    EXPECT_NEAR(squares, of_waves, 1e-6) << "there are no others";
    EXPECT_NEAR(std::sqrt(squares), 0.17, 0.001);
}

// Half the distance on the plane between the places that two neighbouring pixels see.
TEST(Ground, FootprintIsHalfTheStepBetweenPixels) {
    Numbers numbers;
    for (int i = 0; i < 100; ++i) {
        const double height = numbers.logIn(0.1, 1000), slope = numbers.logIn(1e-3, 3), pixel = 1e-3;
        const Vec dir = numbers.along(1) + Vec(0, -slope, 0),
                  step = numbers.along(pixel) + Vec(0, numbers.in(-1, 1) * pixel, 0);
        const auto met = [&](double pixels) {
            const Vec through = dir + pixels * step;
            return through * (-height / through.y);
        };
        const double near = 1e-4 * std::min(slope / pixel, 1.0);
        const Vec exact = (met(near) - met(-near)) / (4 * near);
        const Vec got = physics::groundFootprint(dir, step, height / slope);
        EXPECT_LT(glm::distance(got, Vec(exact.x, 0, exact.z)), 1e-6 * glm::length(exact)) << height << ' ' << slope;
    }
}

// In float, up to 10 km from the origin, only places are rounded: three times, each by at most 2^-24 of their distance
// or of the period of 64 * size. The amplitudes times the wave numbers are 52 / size together.
TEST(Ground, FloatHoldsFarFromTheOrigin) {
    Numbers numbers;
    double largest = 0;
    for (int i = 0; i < 20'000; ++i) {
        const float size = float(numbers.logIn(0.5, 1000)), far = float(numbers.logIn(1, 10'000));
        const glm::vec3 x(float(numbers.in(-1, 1)) * far, 0, float(numbers.in(-1, 1)) * far);
        const glm::vec3 a(numbers.along(double(size) * numbers.logIn(1e-4, 1))),
            b(numbers.along(double(size) * numbers.logIn(1e-4, 1)));
        const double exact = physics::groundStructure(double(x.x), double(x.z), Vec(a), Vec(b), double(size));
        const double rounded = 3 * std::sqrt(2.0) * std::ldexp(std::max(double(far), 64 * double(size)), -24);
        const double error = std::abs(double(physics::groundStructure(x.x, x.z, a, b, size)) - exact);
        EXPECT_LT(error, 1e-5 + 52 / double(size) * rounded) << size << ' ' << far;
        if (size > 5) largest = std::max(largest, error);
    }
    EXPECT_LT(largest, 4e-3) << "waves from 11 cm on";
}

// At the horizon, far beyond it and with the smallest waves nothing overflows, and nothing of the structure is left.
TEST(Ground, FloatIsFiniteAtTheHorizon) {
    for (const float down : {-1e-3f, -1e-9f, -1e-30f})
        for (const float depth : {1e7f, 1e20f, 1e30f})
            for (const float size : {1e-3f, 1.0f, 1e4f}) {
                const glm::vec3 dir(0.6f, down, -0.8f);
                const glm::vec3 a = physics::groundFootprint(dir, glm::vec3(1e-3f, 0, 1e-3f), depth),
                                b = physics::groundFootprint(dir, glm::vec3(0, -1e-3f, 0), depth);
                const float f = physics::groundStructure(dir.x * depth, dir.z * depth, a, b, size);
                EXPECT_NEAR(f, 0, 1e-3f) << down << ' ' << depth << ' ' << size;
            }
}

TEST(Ground, AlbedoStaysAnAlbedo) {
    for (const double albedo : {0.0, 0.1, 0.5, 0.8, 1.0})
        for (const double structure : {0.0, 0.3, 1.0})
            for (const double mean : {-1.0, -0.4, 0.0, 0.7, 1.0}) {
                const double got = physics::groundAlbedo(Vec(albedo), structure, mean).x;
                EXPECT_GE(got, 0);
                EXPECT_LE(got, 1);
                if (albedo * (1 + structure) <= 1) {
                    EXPECT_NEAR(got, albedo * (1 + structure * mean), 1e-15);
                }
            }
}

} // namespace
} // namespace brume::ground_test
