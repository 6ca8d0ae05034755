// Closed forms of slabs: light that varies within one, and particles that slabs widen.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "shaders/shared/scatter.h"
#include "shaders/shared/slab_growth.h"
#include "shaders/shared/widened.h"

namespace brume {
namespace {

// Mass between two points, by a midpoint rule.
double massBetween(double deviation, double lo, double hi) {
    constexpr int kSteps = 20000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double z = lo + (hi - lo) * (i + 0.5) / kSteps;
        sum += std::exp(-0.5 * z * z / (deviation * deviation)) / deviation * (hi - lo) / kSteps;
    }
    return sum;
}

TEST(WidenedShare, KeepsTheMassBetweenTheEnds) {
    for (const double wide : {1.2, 3.0})
        for (const auto& [lo, hi] : {std::pair(-8.0, 8.0), std::pair(-0.5, 8.0), std::pair(-0.1, 2.0)}) {
            const double share = physics::widenedShare(0.8, wide, lo, hi);
            EXPECT_NEAR(share * massBetween(wide, lo, hi), massBetween(0.8, lo, hi), 1e-6) << wide << ' ' << lo;
        }
    EXPECT_NEAR(physics::widenedShare(1.0, 2.0, -1e3, 1e3), 1, 1e-12);
    EXPECT_LT(physics::widenedShare(1.0, 2.0, 9.0, 12.0), 1e-9) << "where the own one has nothing";
    EXPECT_LE(physics::widenedShare(1.0f, 1e30f, -1.0f, 1.0f), 4);
    EXPECT_TRUE(std::isfinite(physics::widenedShare(1e-18f, 1.0f, -1e6f, 1e6f)));
}

// A slab of extinction D (1 + slope t) and light depth light + rise t + bend (t^2 - 1/4) / 2, t from -1/2 to 1/2: the
// exact integral of what is scattered and leaves on the near side.
double exactSlab(double depth, double light_in, double light_out, double slope, double bend) {
    constexpr int kSteps = 4000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double t = (i + 0.5) / kSteps - 0.5;
        const double before = depth * (t + 0.5 + slope * (t * t - 0.25) / 2);
        const double light = light_in + (light_out - light_in) * (t + 0.5) + bend * (t * t - 0.25) / 2;
        sum += depth * (1 + slope * t) * std::exp(-before - light) / kSteps;
    }
    return sum;
}

TEST(ScatterVaried, IsExactToFirstOrderInSlopeAndBend) {
    for (const double depth : {0.01, 0.3, 1.0})
        for (const double rise : {-1.0, 0.0, 0.6})
            for (const double slope : {-1.0, 0.5})
                for (const double bend : {-0.2, 0.3}) {
                    const double in = 1.2, out = in + rise * depth, bent = bend * depth;
                    const double plain = physics::scatterAnalytic(depth, in, out);
                    const double varied = plain * physics::scatterVaried(depth, in, out, slope, bent);
                    const double exact = exactSlab(depth, in, out, slope, bent);
                    EXPECT_NEAR(varied, exact, (0.0065 * depth * depth + 2e-6) * exact) << depth << ' ' << rise;
                    if (std::abs(bent - slope * rise * depth) > 0.1) {
                        EXPECT_LT(std::abs(varied - exact), 0.35 * std::abs(plain - exact)) << depth << ' ' << rise;
                    }
                }
}

TEST(ScatterVaried, IsOneWhereNothingVariesAndBoundedEverywhere) {
    EXPECT_EQ(physics::scatterVaried(2.0, 0.3, 0.3, 1.5, 0.0), 1); // light does not vary
    EXPECT_EQ(physics::scatterVaried(2.0, 0.3, 0.9, 0.0, 0.0), 1);
    // View and light from the same side, both through a slab of any slope: opacity of both is exact without it.
    EXPECT_NEAR(physics::scatterVaried(0.5, 0.2, 0.7, 0.8, 0.4), 1, 1e-12);
    std::mt19937 random(8);
    std::uniform_real_distribution<float> exponent(-6, 38), sign(-1, 1);
    for (int i = 0; i < 20000; ++i) {
        const auto any = [&] { return std::pow(10.0f, exponent(random)); };
        const float ratio =
            physics::scatterVaried(any(), any(), any(), 2 * sign(random), std::copysign(any(), sign(random)));
        ASSERT_TRUE(ratio >= 0.5f && ratio <= 2) << ratio;
    }
}

// Light that a homogeneous medium sends through a face: 1 - e^-x up to a depth x. `rate`: depth of an interval.
TEST(AddedBefore, IsExactWhereIntervalsGrowOrFallGeometrically) {
    const auto upTo = [](double x) { return -std::expm1(-x); };
    for (const double rate : {-5.0, -0.7, 1e-9, 0.4, 3.0})
        for (const double at : {0.0, 0.25, 0.5, 1.0}) {
            const double own = upTo(rate) * (rate < 0 ? -1 : 1), before = own * std::exp(rate),
                         behind = own * std::exp(-rate), exact = upTo(rate * at) / upTo(rate);
            EXPECT_NEAR(physics::addedBefore(before, own, behind, at), exact, 1e-8) << rate << ' ' << at;
            EXPECT_NEAR(physics::addedBefore(0.0, own, behind, at), exact, 1e-8) << "the first";
            EXPECT_NEAR(physics::addedBefore(before, own, 0.0, at), exact, 1e-8) << "the last";
        }
    EXPECT_EQ(physics::addedBefore(0.0, 1.0, 0.0, 0.3), 0.3);
    EXPECT_EQ(physics::addedBefore(1.0, 0.0, 1.0, 0.3), 0.3);
}

// Errors of a Gaussian's intervals fall with the third power of their length; by a straight line with the second.
TEST(AddedBefore, FollowsAGaussian) {
    const auto upTo = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
    double worst[2] = {0, 0}, straight = 0;
    for (int finer = 0; finer < 2; ++finer)
        for (double x = -3; x < 3; x += 0.01) {
            const double h = finer ? 0.2 : 0.4, own = upTo(x + h) - upTo(x);
            const double part = physics::addedBefore(upTo(x) - upTo(x - h), own, upTo(x + 2 * h) - upTo(x + h), 0.5);
            const double error = std::abs(part * own - (upTo(x + h / 2) - upTo(x))) / own;
            worst[finer] = std::max(worst[finer], error);
            if (!finer) straight = std::max(straight, std::abs(0.5 * own - (upTo(x + h / 2) - upTo(x))) / own);
        }
    EXPECT_LT(worst[0], 0.05 * straight);
    EXPECT_LT(worst[1], worst[0] / 7);
}

TEST(AddedBefore, IsAPartForAllInputs) {
    std::mt19937 random(9);
    std::uniform_real_distribution<float> exponent(-44, 38), part(0, 1);
    for (int i = 0; i < 20000; ++i) {
        const auto any = [&] { return std::pow(10.0f, exponent(random)) * (random() % 8 ? 1.0f : -1.0f); };
        const float added = physics::addedBefore(any(), any(), any(), part(random));
        ASSERT_TRUE(added >= 0 && added <= 1.000001f) << added;
    }
}

template <typename real>
physics::GrownSlab<real> grownSlab(real before, real own, real behind) {
    return physics::grownSlab(physics::slabLog(before), physics::slabLog(own), physics::slabLog(behind));
}

double rootMean(double sum, int count) { return std::sqrt(sum / count); }

// A Gaussian of deviation 1, lit by a light whose least distance from the ray is `distance` and `along` behind its
// middle; slabs have their own depths only. Error of the light that it scatters, root mean square over phases of the
// slabs: with growth and without.
struct SlabsErrors {
    double grown, even;
};
SlabsErrors litGaussian(double thickness, double distance, double along) {
    constexpr int kPhases = 8, kSteps = 200;
    constexpr double kEnd = 8;
    const auto upTo = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
    const auto light = [&](double z) { return 1 / ((z - along) * (z - along) + distance * distance); };
    double grown_sum = 0, even_sum = 0, exact = 0;
    for (double z = -kEnd; z < kEnd; z += 1e-3) exact += (upTo(z + 1e-3) - upTo(z)) * light(z + 5e-4);
    for (int phase = 0; phase < kPhases; ++phase) {
        double grown = 0, even = 0;
        for (double z = -kEnd + thickness * phase / kPhases; z < kEnd; z += thickness) {
            const double own = upTo(z + thickness) - upTo(z);
            const auto slab =
                grownSlab(upTo(z) - upTo(z - thickness), own, upTo(z + 2 * thickness) - upTo(z + thickness));
            for (int i = 0; i < kSteps; ++i) {
                const double at = (i + 0.5) / kSteps, lit = own * light(z + at * thickness) / kSteps;
                grown += physics::grownPlace(slab, at).extinction * lit, even += lit;
            }
        }
        grown_sum += (grown / exact - 1) * (grown / exact - 1), even_sum += (even / exact - 1) * (even / exact - 1);
    }
    return {rootMean(grown_sum, kPhases), rootMean(even_sum, kPhases)};
}

// Errors fall with the fourth power of the thickness; of even extinction with the second.
TEST(SlabGrowth, FollowsALitGaussian) {
    for (const auto& [distance, along] : {std::pair(3.0, 0.0), std::pair(3.0, 3.0), std::pair(1.0, 0.0)}) {
        const SlabsErrors thick = litGaussian(0.8, distance, along), thin = litGaussian(0.4, distance, along);
        EXPECT_LT(thick.grown, 0.06 * thick.even) << distance << ' ' << along;
        EXPECT_LT(thin.grown, thick.grown / 10) << distance << ' ' << along;
        EXPECT_GT(thin.even, thick.even / 5) << distance << ' ' << along;
    }
}

TEST(SlabGrowth, IsExactWhereExtinctionGrowsOrFallsGeometrically) {
    for (const double rate : {-5.0, -0.7, 0.0, 0.4, 3.0}) {
        const auto slab = grownSlab(2 * std::exp(-rate), 2.0, 2 * std::exp(rate));
        EXPECT_NEAR(grownSlab(0.0, 2.0, 2 * std::exp(rate)).growth, rate, 1e-9) << "the first";
        EXPECT_NEAR(grownSlab(2 * std::exp(-rate), 2.0, 0.0).growth, rate, 1e-9) << "the last";
        double sum = 0, moment = 0;
        for (int i = 0; i < 2000; ++i) {
            const double at = (i + 0.5) / 2000, extinction = physics::grownPlace(slab, at).extinction;
            EXPECT_NEAR(physics::grownPlace(slab, at).before, sum + 0.5 * extinction / 2000, 1e-5) << rate;
            sum += extinction / 2000, moment += extinction * (at - 0.5) / 2000;
        }
        EXPECT_NEAR(sum, 1, 1e-5) << rate;
        EXPECT_NEAR(physics::grownShift(slab), moment, std::abs(rate) > 4 ? 0.02 : 0.006) << rate;
    }
}

TEST(SlabGrowth, IsFiniteForAllInputs) {
    std::mt19937 random(10);
    std::uniform_real_distribution<float> exponent(-44, 38), part(0, 1);
    for (int i = 0; i < 20000; ++i) {
        const auto any = [&] { return std::pow(10.0f, exponent(random)) * (random() % 8 ? 1.0f : 0.0f); };
        const auto slab = grownSlab(any(), any(), any());
        const auto place = physics::grownPlace(slab, part(random));
        ASSERT_TRUE(place.before >= -1e-6f && place.before <= 1.000001f) << place.before;
        ASSERT_TRUE(place.extinction >= 0 && place.extinction <= 10) << place.extinction;
    }
}

} // namespace
} // namespace brume
