// Fog's optical depth in float32 against the same integral with more digits, and fog that is lit past itself.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "shaders/shared/fog.h"
#include "shaders/shared/scatter.h"
#include "tests/unit/worst.h"

namespace brume {
namespace {

// Integral of sigma e^(-k y) from height `from` to height `to` over a length.
long double exactDepth(long double sigma, long double k, long double from, long double to, long double length) {
    const long double lower = std::min(from, to), rise = k * std::abs(to - from);
    const long double mean = rise > 0 ? -std::expm1(-rise) / rise : 1;
    return sigma * std::exp(-k * lower) * mean * length;
}

TEST(Fog, DepthInFloat) {
    Worst worst;
    for (const double k : {0.0, 1e-6, 1e-3, 0.05, 1.0})
        for (const double height : {-80.0, -1.0, 0.0, 2.0, 40.0})
            for (const double climb : {-1.0, -0.3, -1e-3, -1e-7, 0.0, 1e-7, 1e-4, 0.2, 1.0})
                for (const double length : {1e-3, 0.5, 30.0, 4e3}) {
                    const double end = height + climb * length;
                    // Exponents are rounded to 6e-8 of themselves.
                    if (k * std::max(std::abs(height), std::abs(end)) > 16 && k * std::abs(climb) * length < 80)
                        continue;
                    if (-k * std::min(height, end) > 59) continue; // denser than any number
                    const auto sigma = 0.02f, k_f = float(k), height_f = float(height), climb_f = float(climb);
                    const float value = physics::fogDepth(sigma, k_f, height_f, climb_f, 1.0f, 0.0f, float(length));
                    const long double exact = exactDepth(
                        sigma, k_f, height_f, height_f + (long double)(climb_f) * float(length), float(length));
                    if (exact > 1e-30L) worst.relative(double(value), double(exact), k * height, k * climb * length);
                }
    EXPECT_LT(worst.deviation(), 2e-6) << worst;
}

TEST(Fog, DepthOfTwoHalvesIsThatOfTheWhole) {
    Worst worst;
    for (const float k : {0.0f, 0.3f, 2.0f})
        for (const float climb : {-0.7f, -1e-5f, 0.0f, 0.6f})
            for (const float middle : {0.1f, 3.0f, 9.9f}) {
                const auto depth = [&](float begin, float end) {
                    return physics::fogDepth(0.1f, k, 1.0f, climb, 1.0f, begin, end);
                };
                worst.relative(double(depth(0, middle) + depth(middle, 10)), double(depth(0, 10)), double(k * climb),
                               double(middle));
            }
    EXPECT_LT(worst.deviation(), 1e-6) << worst;
}

TEST(Fog, EndlessRaysHaveFiniteDepths) {
    const auto endless = [](float k, float height, float climb) {
        return physics::fogDepth(0.02f, k, height, climb, 1.0f, 0.0f, 1e30f);
    };
    EXPECT_NEAR(endless(0.1f, 0, 0.5f), 0.02 / (0.1 * 0.5), 1e-6); // sigma / (k climb)
    EXPECT_NEAR(endless(0.1f, 10, 0.5f), 0.02 / (0.1 * 0.5) * std::exp(-1.0), 1e-6);
    EXPECT_EQ(endless(0.1f, 0, -0.5f), 1e18f);
    EXPECT_EQ(endless(0, 0, 0.5f), 1e18f);
    EXPECT_EQ(endless(0.1f, -1e4f, 0), 1e18f);
    EXPECT_EQ(physics::fogDepth(0.02f, 100.0f, 5e4f, 0.0f, 1.0f, 0.0f, 1e30f), 0);
    EXPECT_EQ(physics::fogDepth(0.02f, 0.1f, 0.0f, 1.0f, 1.0f, 3.0f, 2.0f), 0); // an empty part
}

TEST(Fog, DistanceIsTheInverseOfDepth) {
    Worst worst;
    for (const float k : {0.0f, 1e-5f, 0.3f, 3.0f})
        for (const float climb : {-0.8f, -1e-4f, 0.0f, 0.3f})
            for (const float depth : {1e-3f, 0.4f, 60.0f}) {
                const float t = physics::fogDistance(0.05f, k, 1.0f, climb, 1.3f, 2.0f, depth);
                const float all = physics::fogDepth(0.05f, k, 1.0f, climb, 1.3f, 2.0f, 1e30f);
                if (t < 1e30f)
                    worst.relative(double(physics::fogDepth(0.05f, k, 1.0f, climb, 1.3f, 2.0f, 2 + t)), double(depth),
                                   double(k * climb), double(depth));
                else
                    EXPECT_LE(all, 1.00001f * depth); // there is not so much
            }
    EXPECT_LT(worst.deviation(), 2e-4) << worst; // 2 + t is rounded
}

TEST(Fog, PartsOfRays) {
    const glm::vec3 origin(0, 5, 0);
    const float far = 1e30f;
    const auto part = [&](float lo, float hi, float radius, glm::vec3 dir) {
        const physics::FogPart<float> p =
            physics::insideFog(lo, hi, glm::vec3(0, 5, -10), radius, origin, dir, 0.05f, far);
        return glm::dvec2(p.begin, std::max(p.begin, p.end));
    };
    EXPECT_EQ(part(-far, far, far, {0.3f, -0.2f, -1}), glm::dvec2(0.05f, far));
    EXPECT_EQ(part(-far, 3, far, {0, -1, 0}), glm::dvec2(2, far));
    EXPECT_EQ(part(1, 3, far, {0, -2, 0}), glm::dvec2(1, 2));      // in units of the direction
    EXPECT_EQ(part(-far, 3, far, {0, 1, 0}).y, double(0.05f));     // away from it
    EXPECT_EQ(part(-far, 3, far, {1, 0, 0}), glm::dvec2(0.05f));   // level, above it
    EXPECT_EQ(part(4, 6, far, {1, 0, 0}), glm::dvec2(0.05f, far)); // level, in it
    EXPECT_EQ(part(-far, far, 2, {0, 0, -1}), glm::dvec2(8, 12));
    EXPECT_EQ(part(-far, far, 20, {0, 0, -1}), glm::dvec2(0.05f, 30)); // from inside
    EXPECT_EQ(part(-far, far, 2, {0, 0, 1}).y, double(0.05f));
    const glm::dvec2 beside = part(-far, far, 2, {1, 0, -1}); // passes it by
    EXPECT_EQ(beside.x, beside.y);
    EXPECT_EQ(part(4.5f, 5.5f, 2, {0, 0, -1}), glm::dvec2(8, 12)); // both at once
}

// Height fog, lit from above at any slope and seen along any ray: the depth that light passes is linear in the fog's
// own, so that one interval is exact. Against 20,000 steps.
TEST(Fog, LightOfHeightFogIsExactInOneInterval) {
    Worst worst;
    const double sigma = 0.3, k = 0.4, height = 2, sun = 0.6;
    for (const double climb : {-0.9, -0.1, 0.05, 0.8})
        for (const double length : {0.5, 6.0, 40.0}) {
            const auto toward = [&](double t) { // the light's depth there
                return physics::fogDepth(sigma, k, height + climb * t, sun, 1.0, 0.0, 1e30);
            };
            const double own = physics::fogDepth(sigma, k, height, climb, 1.0, 0.0, length);
            const double value = physics::scatterOwn(own, toward(0), own + toward(length));
            double sum = 0;
            constexpr int kSteps = 20000;
            for (int i = 0; i < kSteps; ++i) {
                const double t = (i + 0.5) / kSteps * length;
                const double before = physics::fogDepth(sigma, k, height, climb, 1.0, 0.0, t);
                sum += length / kSteps * sigma * std::exp(-k * (height + climb * t)) * std::exp(-before - toward(t));
            }
            worst.relative(value, sum, climb, length);
        }
    EXPECT_LT(worst.deviation(), 1e-6) << worst;
}

TEST(Fog, ScatteredByOneMediumAlone) {
    for (const double depth : {1e-6, 0.3, 4.0, 90.0})
        for (const double in : {0.0, 0.7, 20.0})
            for (const double out : {0.0, 2.0, 30.0})
                EXPECT_DOUBLE_EQ(physics::scatterOwn(depth, in, depth + out), physics::scatterAnalytic(depth, in, out));
}

} // namespace
} // namespace brume
