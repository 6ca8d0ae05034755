// Closed forms of shaders/shared/lit_particles.h against integrals in double, and in float where numbers are hard.
#include <vector>

#include <gtest/gtest.h>

#include "shaders/shared/lit_particles.h"

namespace brume::physics {
namespace {

using Vec = glm::dvec3;

// Integral over [from, to] by so many midpoints.
template <class F>
double integral(double from, double to, const F& f, int steps = 20000) {
    double sum = 0;
    for (int i = 0; i < steps; ++i) sum += f(from + (to - from) * (i + 0.5) / steps);
    return sum * (to - from) / steps;
}
double gaussian(double q) { return std::exp(-q * q) / 1.7724538509055159; }

TEST(LitParticles, SumsAreIntegralsOfTheGaussian) {
    for (const double from : {-12.0, -2.5, -0.3, 0.0, 0.7, 3.0})
        for (const double to : {-1.0, 0.1, 1.5, 2.0, 12.0}) {
            if (to <= from) continue;
            const auto a = litSums<double>(from), b = litSums<double>(to);
            EXPECT_NEAR(b.whole - a.whole, integral(from, to, gaussian), 4e-7);
            EXPECT_NEAR(b.first - a.first, integral(from, to, [](double q) { return q * gaussian(q); }), 4e-7);
            EXPECT_NEAR(b.second - a.second, integral(from, to, [](double q) { return q * q * gaussian(q); }), 4e-7);
        }
}

TEST(LitParticles, ALineHasTheFitOfItsPlaces) {
    const LitFit<double> fit{0.5, {0.1, -0.2, 0.05}, {0.03, -0.02, 0.01}, {0.04, -0.01, 0.02}};
    const Vec w = glm::normalize(Vec(0.3, -0.5, 0.8)), nearest = glm::cross(w, Vec(0.2, 0.9, -0.4));
    const auto line = litLine<double>(fit, nearest, w);
    for (const double q : {-1.5, -0.2, 0.0, 0.4, 2.0}) {
        const Vec u = nearest + q * w;
        const double there = fit.middle + glm::dot(fit.slope, u) + glm::dot(fit.bend, u * u) +
                             2 * (fit.twist.x * u.y * u.z + fit.twist.y * u.z * u.x + fit.twist.z * u.x * u.y);
        EXPECT_NEAR(line.middle + line.slope * q + line.bend * q * q, there, 1e-12);
    }
}

// Parts of a particle add up to the whole of it, and light to its mean over the Gaussian.
TEST(LitParticles, PartsAddUp) {
    const LitLine<double> light{0.4, 0.12, 0.05};
    const double line = 0.8;
    double depth = 0, lit = 0;
    auto before = litSums<double>(-1e9);
    for (const double end : {-3.0, -1.0, -0.4, 0.2, 0.25, 1.1, 1e9}) {
        const auto to = litSums<double>(end);
        const auto part = litPart<double>(line, light, before, to);
        EXPECT_GE(part.lit, 0);
        EXPECT_LE(part.lit, part.depth);
        depth += part.depth, lit += part.lit;
        before = to;
    }
    EXPECT_NEAR(depth, line, 1e-6);
    EXPECT_NEAR(lit, line * (light.middle + 0.5 * light.bend), 1e-6) << "q^2 has the mean 1/2, q has 0";
}

TEST(LitParticles, MomentsAreIntegralsBehindThePlane) {
    const double line = 0.6, k = 1.7, closest = 2.5;
    for (const double plane : {-1e9, 1.0, 2.5, 3.2}) {
        const auto moments = litMoments<double>(line, k, closest, litSums<double>(k * (plane - closest)));
        const auto at = [&](int power) {
            return integral(std::max(plane, closest - 8 / k), closest + 8 / k,
                            [&](double t) { return std::pow(t, power) * line * k * gaussian(k * (t - closest)); });
        };
        for (int power = 0; power < 3; ++power) EXPECT_NEAR(moments[power], at(power), 3e-6 * (1 + at(power)));
    }
}

TEST(LitParticles, SlabsLieWhereTheMediumIs) {
    // Two particles of equal depth, 4 m apart.
    const double k = 3;
    Vec moments(0);
    for (const double at : {10.0, 14.0}) moments += litMoments<double>(0.5, k, at, litSums<double>(-1e9));
    const auto range = litRange<double>(moments, 0);
    const double deviation = std::sqrt(4 + 0.5 / (k * k));
    EXPECT_NEAR(range.begin, 12 - 2.2 * deviation, 1e-5);
    EXPECT_NEAR(range.end, 12 + 2.2 * deviation, 1e-5);
    EXPECT_EQ(litEdge<double>(range, 0), range.begin);
    EXPECT_NEAR(litEdge<double>(range, 1), range.end, 1e-12);
    double before = range.begin, thinnest = 0;
    for (int i = 1; i <= 8; ++i) {
        const double edge = litEdge<double>(range, i / 8.0);
        EXPECT_GT(edge - before, thinnest) << "those in front are thinner";
        thinnest = edge - before, before = edge;
    }
    EXPECT_EQ(litRange<double>(moments, 11).begin, 11) << "not before the eye's near plane";
    const auto none = litRange<double>(Vec(0), 0.05);
    EXPECT_TRUE(std::isfinite(none.begin) && std::isfinite(none.end) && none.end > none.begin);
}

// What a slab sends whose source grows linearly from front to back.
TEST(LitParticles, SlabsSendWhatTheirIntegralSays) {
    for (const double depth : {1e-4, 0.05, 0.29, 0.31, 1.0, 4.0, 30.0}) {
        const auto sent = [&](double slope) {
            return integral(
                0, 1, [&](double x) { return (1 + slope * (x - 0.5)) * depth * std::exp(-depth * x); }, 200000);
        };
        EXPECT_NEAR(litEven<double>(depth), sent(0), 1e-6 * sent(0));
        EXPECT_NEAR(litRising<double>(depth), sent(1) - sent(0), 1.5e-3 * std::abs(sent(1) - sent(0)) + 1e-9);
        // Neighbours whose sources differ by as much tell the slope.
        EXPECT_NEAR(litSlab<double>(0.8 * depth, depth, 1.2 * depth, Vec(depth)), sent(0.2), 1e-3 * sent(0.2));
    }
    EXPECT_EQ(litSlab<double>(1, 0, 1, Vec(1, 0, 1)), 0);
    EXPECT_NEAR(litSlab<double>(0, 0.3, 0, Vec(0, 0.3, 0)), litEven<double>(0.3), 1e-12) << "no neighbours: even";
}

TEST(LitParticles, WhatLiesBeforeASurfaceIsMonotone) {
    EXPECT_NEAR(litBefore<double>({1, 1, 1}, {1, 1, 1}, 0.3), 0.3, 1e-12) << "an even medium";
    for (const Vec sums : {Vec(0, 1, 0), Vec(0.1, 1, 3), Vec(5, 1, 0), Vec(0, 1, 1000), Vec(2, 0, 2)}) {
        double before = 0;
        for (int i = 0; i <= 100; ++i) {
            const double here = litBefore<double>(sums, {0.5, 1, 2}, i / 100.0);
            EXPECT_GE(here, before - 1e-12);
            before = here;
        }
        EXPECT_EQ(litBefore<double>(sums, {0.5, 1, 2}, 0), 0);
        EXPECT_NEAR(before, sums.y, 1e-12);
    }
    // Slabs of a Gaussian, half a deviation thick: between their edges it errs little.
    const auto slab = [](int i) {
        return 0.5 * (std::erf((i + 1) * 0.5 / std::sqrt(2.0)) - std::erf(i * 0.5 / std::sqrt(2.0)));
    };
    for (int i = -4; i < 4; ++i)
        for (const double at : {0.25, 0.5, 0.75}) {
            const double truth = 0.5 * (std::erf((i + at) * 0.5 / std::sqrt(2.0)) - std::erf(i * 0.5 / std::sqrt(2.0)));
            EXPECT_NEAR(litBefore<double>({slab(i - 1), slab(i), slab(i + 1)}, Vec(0.5), at), truth, 0.002);
        }
}

// float32 where its numbers are hard: far eyes, tiny and huge particles, dense ones.
TEST(LitParticles, FloatsSurvive) {
    for (const float k : {1e-3f, 1.0f, 700.0f})
        for (const float closest : {0.0f, 3.0f, 1e4f})
            for (const float sigma : {1e-6f, 1.0f, 1e5f}) {
                const float line = lineDepth<float>(sigma, k, 1);
                const auto from = litSums<float>(k * (0.05f - closest));
                const glm::vec3 moments = litMoments<float>(line, k, closest, from);
                const auto range = litRange<float>(moments, 0.05f);
                float depth = 0, lit = 0;
                auto before = from;
                for (int i = 1; i <= 8; ++i) {
                    const float edge = litEdge<float>(range, float(i) / 8);
                    const auto to = litSums<float>(i < 8 ? k * (edge - closest) : 1e9f);
                    const auto part = litPart<float>(line, {0.5f, 0.1f, -0.1f}, before, to);
                    depth += part.depth, lit += part.lit;
                    EXPECT_TRUE(std::isfinite(litSlab<float>(lit, part.lit, 0, glm::vec3(depth, part.depth, 0))));
                    before = to;
                }
                const float whole = line * (0.5f - from.whole);
                EXPECT_NEAR(depth, whole, 2e-6f * line + 1e-30f);
                EXPECT_TRUE(std::isfinite(lit) && lit >= 0 && lit <= depth * 1.00001f);
            }
    for (float depth = 1e-8f; depth < 1e8f; depth *= 3) {
        EXPECT_LE(litEven<float>(depth), 1.0000005f);
        EXPECT_LE(litRising<float>(depth), 0);
        EXPECT_GE(litRising<float>(depth), -0.5000005f);
        EXPECT_NEAR(litRising<float>(depth), litRising<double>(double(depth)), 3e-6);
    }
}

} // namespace
} // namespace brume::physics
