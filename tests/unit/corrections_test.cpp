// What measuring says of the laws: bounded, quick to mend, and no swinging between ways. Times are passed in.
#include "server/plan/corrections.h"

#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "common/random.h"
#include "tests/unit/plan_scenes.h"

namespace brume::corrections_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kLaw = 0.004; // predicted error

const Corrections::Time kStart = Corrections::Time{} + std::chrono::hours(1);

Corrections::Ratio ratio(double middle, double wide = 1.1) { return {middle, middle / wide, middle * wide}; }

TEST(Corrections, ABrokenPromiseIsMendedAtOnceAndAFallWaits) {
    Corrections c;
    EXPECT_EQ(c.factor(1, "slabs", kLaw), 1);
    c.learn(1, "slabs", kLaw, ratio(3), kStart);
    EXPECT_NEAR(c.factor(1, "slabs", kLaw), 3.075, 1e-9);
    EXPECT_EQ(c.factor(1, "grid", kLaw), 1);
    Corrections::Time now = kStart;
    for (; now < kStart + seconds(9); now += milliseconds(100)) c.learn(1, "slabs", kLaw, ratio(0.5), now);
    EXPECT_NEAR(c.factor(1, "slabs", kLaw), 3.075, 1e-9);
    for (; now < kStart + seconds(60); now += milliseconds(100)) c.learn(1, "slabs", kLaw, ratio(0.5), now);
    EXPECT_NEAR(c.factor(1, "slabs", kLaw), 0.55, 0.01);
}

TEST(Corrections, AreBoundedAndFadeWhereNobodyMeasures) {
    Corrections c;
    c.learn(1, "slabs", kLaw, ratio(1e9), kStart);
    EXPECT_EQ(c.factor(1, "slabs", kLaw), Corrections::kMost);
    c.fade(kStart + seconds(29));
    EXPECT_EQ(c.factor(1, "slabs", kLaw), Corrections::kMost);
    for (int s = 30; s <= 90; ++s) c.fade(kStart + seconds(s));
    EXPECT_NEAR(c.factor(1, "slabs", kLaw), std::sqrt(Corrections::kMost), 0.1);
    for (int s = 90; s <= 2000; ++s) c.fade(kStart + seconds(s));
    EXPECT_EQ(c.factor(1, "slabs", kLaw), 1);
    Corrections low;
    for (int s = 0; s < 100; ++s) low.learn(1, "slabs", kLaw, ratio(1e-9), kStart + seconds(s));
    EXPECT_NEAR(low.factor(1, "slabs", kLaw), Corrections::kLeast, 1e-6);
}

TEST(Corrections, AnUncertainRiseComesSlowly) {
    Corrections c;
    c.learn(1, "slabs", kLaw, ratio(1.2, 2), kStart); // 0.6 to 2.4: perhaps nothing is wrong
    EXPECT_LT(c.factor(1, "slabs", kLaw), 1.01);
    for (int i = 1; i <= 100; ++i) c.learn(1, "slabs", kLaw, ratio(1.2, 2), kStart + milliseconds(100 * i));
    EXPECT_NEAR(c.factor(1, "slabs", kLaw), 1.5, 0.02);
}

TEST(Corrections, FineAndCoarsePicturesHaveFactorsOfTheirOwn) {
    Corrections c;
    c.learn(1, "slabs", 0.004, ratio(1.5), kStart);
    EXPECT_EQ(c.factor(1, "slabs", 0.001), c.factor(1, "slabs", 0.004)) << "nothing is known of finer pictures";
    c.learn(1, "slabs", 0.001, ratio(0.5), kStart + seconds(1));
    const double coarse = c.factor(1, "slabs", 0.004), fine = c.factor(1, "slabs", 0.001);
    EXPECT_GT(coarse, 1.5);
    EXPECT_LT(fine, 0.6) << "the factor of coarser pictures was a guess, and is given up at once";
    EXPECT_NEAR(c.factor(1, "slabs", 0.002), std::sqrt(coarse * fine), 0.05);
    EXPECT_NEAR(c.factor(1, "slabs", 0.1), coarse, 1e-9);
    EXPECT_NEAR(c.factor(1, "slabs", 0.00001), fine, 0.02);
}

TEST(Corrections, WhoIsNewHasWhatTheOthersHave) {
    Corrections c;
    c.learn(1, "slabs", kLaw, ratio(2), kStart);
    c.learn(2, "slabs", kLaw, ratio(3), kStart);
    EXPECT_EQ(c.factor(3, "slabs", kLaw), c.factor(2, "slabs", kLaw));
    EXPECT_LT(c.factor(1, "slabs", kLaw), c.factor(2, "slabs", kLaw));
}

// Ways from cheap to dear, each with a predicted and a true error; the plan takes the cheapest that holds. Returns how
// often the way changes in an hour, and the part of the time in which the promise is broken.
struct Outcome {
    int changes = 0;
    double broken = 0;
    std::array<double, 3> in_way{}; // parts of the time
};
struct Way {
    double predicted, is;
};
Outcome simulate(const std::vector<Way>& ways, const std::function<double()>& noise) {
    constexpr double kBudget = 0.005;
    Corrections c;
    Outcome out;
    size_t last = 0;
    const int steps = 36000;
    for (int step = 0; step < steps; ++step) {
        const Corrections::Time now = kStart + milliseconds(100 * step);
        const auto predicted = [&](size_t i) { return ways[i].predicted * c.factor(1, "slabs", ways[i].predicted); };
        size_t way = 0;
        while (way + 1 < ways.size() && predicted(way) > kBudget) ++way;
        if (step > 0 && way > last && predicted(last) <= 1.1 * kBudget)
            way = last; // as makePlan() keeps what is in use
        out.changes += step > 0 && way != last;
        out.broken += ways[way].is > kBudget ? 1.0 / steps : 0;
        out.in_way[way] += 1.0 / steps;
        last = way;
        if (step % 5 == 0)
            c.learn(1, "slabs", ways[way].predicted, ratio(ways[way].is / ways[way].predicted * noise(), 1.15), now);
    }
    return out;
}

TEST(Corrections, WrongLawsDoNotMakeThePlanSwing) {
    Random random(3);
    const auto noise = [&] { return std::exp(random.uniform(-0.1f, 0.1f)); };
    // The cheap way is worse than its law, the dear one far better: each says that the other should be taken.
    const Outcome opposite = simulate({{0.004, 0.006}, {0.003, 0.0005}}, noise);
    EXPECT_LE(opposite.changes, 2 * 12);
    EXPECT_LT(opposite.broken, 0.01);
    // The same, and between them a way that its law knows well: it is found, and kept.
    const Outcome middle = simulate({{0.0045, 0.007}, {0.003, 0.0045}, {0.0015, 0.0002}}, noise);
    EXPECT_LE(middle.changes, 12);
    EXPECT_LT(middle.broken, 0.01);
    EXPECT_GT(middle.in_way[1], 0.9);
    const Outcome alike = simulate({{0.004, 0.008}, {0.0024, 0.0048}, {0.001, 0.002}}, noise);
    EXPECT_LE(alike.changes, 4);
    EXPECT_LT(alike.broken, 0.01);
    const Outcome good = simulate({{0.0045, 0.0045}, {0.002, 0.002}}, noise);
    EXPECT_LE(good.changes, 4);
    EXPECT_EQ(good.broken, 0);
    // Far too careful: the cheap way is taken in the end.
    const Outcome careful = simulate({{0.016, 0.0016}, {0.004, 0.0004}}, noise);
    EXPECT_EQ(careful.changes, 1);
}

TEST(Corrections, ThePlanGetsFinerForWhomTheLawFails) {
    PlanInputs inputs = inputsOf(cube());
    inputs.views[0].viewer = 1;
    Corrections c;
    const Plan trusted = makePlan(inputs, builtInCosts());
    inputs.corrections = &c;
    EXPECT_EQ(makePlan(inputs, builtInCosts()).chosen.ms(), trusted.chosen.ms());
    c.learn(1, trusted.chosen.settings.method, trusted.chosen.error, ratio(4), kStart);
    const Plan mended = makePlan(inputs, builtInCosts());
    EXPECT_GT(mended.chosen.ms(), trusted.chosen.ms());
    EXPECT_LE(mended.chosen.error, 0.005);
    EXPECT_NEAR(predictedError(inputs.scene, trusted.chosen.settings, inputs.views[0]), trusted.chosen.error, 1e-9);
    if (mended.chosen.settings.method == trusted.chosen.settings.method) {
        EXPECT_LT(predictedError(inputs.scene, mended.chosen.settings, inputs.views[0]), 0.005 / 4);
    }
}

} // namespace
} // namespace brume::corrections_test
