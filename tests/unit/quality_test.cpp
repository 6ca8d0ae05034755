// What a viewer gets of the device, and what is told of it: without devices, and with a clock that the test turns.
#include <gtest/gtest.h>

#include "server/viewer/history.h"
#include "server/viewer/quality.h"
#include "server/viewer/refinement.h"

namespace brume::quality_test {
namespace {

using std::chrono::milliseconds;

const Clock::time_point kStart = Clock::time_point{} + std::chrono::hours(1);

// Looks every 100 ms for so long; the level at the end.
uint32_t after(QualityControl& quality, Clock::time_point& now, milliseconds time, const DeviceLoad& load) {
    for (const auto end = now + time; now < end; now += milliseconds(100)) quality.observe({.device = load}, now);
    return quality.deviceLevel();
}

TEST(DeviceQuality, SizeAtOnceWhenNothingElseIsLeft) {
    QualityControl quality;
    Clock::time_point now = kStart;
    const DeviceLoad over{.own_ms = 60, .whole_ms = 100, .budget_ms = 50, .viewers = 4, .exhausted = true};
    EXPECT_TRUE(quality.observe({.device = over}, now));
    EXPECT_EQ(quality.deviceLevel(), 1u);
    EXPECT_TRUE(quality.step().half);
    EXPECT_EQ(quality.step().every, 1);
    EXPECT_EQ(quality.step().quality, 100);                       // costs the device nothing
    EXPECT_EQ(quality.level(), 0u);                               // the link's own limit
    EXPECT_EQ(after(quality, now, milliseconds(2000), over), 1u); // the end
    EXPECT_EQ(quality.step().every, 1) << "time between its pictures would make none of them shorter";
}

TEST(DeviceQuality, WhoKeepsTheSizeLosesNothingToTheDevice) {
    QualityControl quality;
    Clock::time_point now = kStart;
    const DeviceLoad over{.own_ms = 60, .whole_ms = 100, .budget_ms = 50, .viewers = 4, .exhausted = true};
    ASSERT_EQ(after(quality, now, milliseconds(2000), over), 1u);
    EXPECT_FALSE(quality.step(true).half);
    EXPECT_EQ(quality.step(true).every, 1);
}

// As many pixels a second as with half the sides, at every level.
TEST(LinkQuality, WhoKeepsTheSizeGetsFewerPictures) {
    QualityControl quality;
    Clock::time_point now = kStart;
    EXPECT_EQ(quality.step(true).every, 1);
    for (uint32_t look = 1; look < QualityControl::kSteps; ++look, now += milliseconds(300)) {
        quality.observe({.queue_ms = 100}, now);
        ASSERT_EQ(quality.level(), look);
        const QualityStep smaller = quality.step(false), slower = quality.step(true);
        EXPECT_FALSE(slower.half);
        EXPECT_EQ(slower.every, (smaller.half ? 4 : 1) * smaller.every);
        EXPECT_EQ(slower.quality, smaller.quality);
    }
    EXPECT_TRUE(quality.step(false).half);
}

TEST(DeviceQuality, WhatReducesAPictureIsKnown) {
    QualityControl quality;
    Clock::time_point now = kStart;
    EXPECT_EQ(quality.reduced(), Reduced::no);
    const DeviceLoad over{.own_ms = 60, .whole_ms = 100, .budget_ms = 50, .viewers = 4, .exhausted = true};
    quality.observe({.device = over}, now);
    EXPECT_EQ(quality.reduced(), Reduced::device);
    for (int i = 0; i < 40; ++i) quality.observe({.queue_ms = 500, .device = over}, now += milliseconds(300));
    ASSERT_EQ(quality.level(), QualityControl::kSteps - 1);
    EXPECT_EQ(quality.reduced(), Reduced::link) << "both are as small, and one has JPEG quality and rate besides";
    QualityControl slow;
    slow.observe({.queue_ms = 500}, now += milliseconds(300));
    EXPECT_EQ(slow.reduced(), Reduced::link);
}

TEST(DeviceQuality, AccuracyComesFirstAndTheCheapPayNothing) {
    QualityControl quality;
    Clock::time_point now = kStart;
    const DeviceLoad accuracy_left{.own_ms = 60, .whole_ms = 100, .budget_ms = 50, .viewers = 4, .exhausted = false};
    EXPECT_EQ(after(quality, now, milliseconds(3000), accuracy_left), 0u);
    const DeviceLoad cheap{.own_ms = 2, .whole_ms = 100, .budget_ms = 50, .viewers = 9, .exhausted = true};
    EXPECT_EQ(after(quality, now, milliseconds(3000), cheap), 0u); // a ninth of 50 is more than 2
    const DeviceLoad within{.own_ms = 30, .whole_ms = 49, .budget_ms = 50, .viewers = 2, .exhausted = true};
    EXPECT_EQ(after(quality, now, milliseconds(3000), within), 0u);
}

// Full size takes up to four times as long: it comes back when that would fit, and then it does not go again.
TEST(DeviceQuality, ComesBackAfterASecondInWhichItWouldFit) {
    QualityControl quality;
    Clock::time_point now = kStart;
    quality.observe(
        {.device = DeviceLoad{.own_ms = 60, .whole_ms = 100, .budget_ms = 50, .viewers = 2, .exhausted = true}}, now);
    ASSERT_EQ(quality.deviceLevel(), 1u);
    const DeviceLoad not_yet{.own_ms = 15, .whole_ms = 20, .budget_ms = 50, .viewers = 2}; // 65 at full size
    EXPECT_EQ(after(quality, now, milliseconds(5000), not_yet), 1u);
    const DeviceLoad room{.own_ms = 5, .whole_ms = 10, .budget_ms = 50, .viewers = 2}; // 25
    EXPECT_EQ(after(quality, now, milliseconds(900), room), 1u);
    EXPECT_EQ(after(quality, now, milliseconds(400), room), 0u);
}

// The others have gone. The picture takes as long as ever, since its rays are as many at half the size.
TEST(DeviceQuality, ComesBackWhenTheOthersHaveGoneHoweverDearItIs) {
    QualityControl quality;
    Clock::time_point now = kStart;
    const DeviceLoad over{.own_ms = 45, .whole_ms = 200, .budget_ms = 50, .viewers = 5, .exhausted = true};
    ASSERT_EQ(after(quality, now, milliseconds(1000), over), 1u);
    const DeviceLoad alone{.own_ms = 43, .whole_ms = 46, .budget_ms = 50, .viewers = 1, .exhausted = true};
    EXPECT_EQ(after(quality, now, milliseconds(1500), alone), 0u);
}

// Each time it comes back there is too much again.
TEST(DeviceQuality, ComesBackLessAndLessOftenWhereItDoesNotFit) {
    QualityControl quality;
    Clock::time_point now = kStart;
    int changes = 0;
    for (uint32_t last = 0; now < kStart + std::chrono::minutes(2); now += milliseconds(100)) {
        const bool small = quality.deviceLevel() > 0;
        quality.observe({.device = DeviceLoad{.own_ms = small ? 20.0 : 100.0,
                                              .whole_ms = small ? 30.0 : 110.0,
                                              .budget_ms = 100 / 1.3,
                                              .viewers = 2,
                                              .exhausted = true}},
                        now);
        if (!small) quality.observe({.device = DeviceLoad{100, 130, 50, 2, true}}, now);
        changes += quality.deviceLevel() != last;
        last = quality.deviceLevel();
    }
    EXPECT_LE(changes, 2 * (5 + 120 / 16));
}

TEST(DeviceQuality, WhereNothingIsDrawnThereIsRoom) {
    QualityControl quality;
    Clock::time_point now = kStart;
    quality.observe(
        {.device = DeviceLoad{.own_ms = 200, .whole_ms = 200, .budget_ms = 50, .viewers = 1, .exhausted = true}}, now);
    ASSERT_EQ(quality.deviceLevel(), 1u);
    EXPECT_EQ(after(quality, now, milliseconds(1500), {.own_ms = 50, .whole_ms = 0, .budget_ms = 50}), 0u);
}

TEST(DeviceQuality, TheLesserOfBothLimitsHolds) {
    QualityControl quality;
    Clock::time_point now = kStart;
    const DeviceLoad over{.own_ms = 60, .whole_ms = 100, .budget_ms = 50, .viewers = 1, .exhausted = true};
    quality.observe({.queue_ms = 60, .device = over}, now);
    EXPECT_EQ(quality.level(), 1u);
    EXPECT_EQ(quality.deviceLevel(), 1u);
    EXPECT_EQ(quality.step().quality, 65); // the link's
    EXPECT_TRUE(quality.step().half);      // the device's
}

TEST(Refinement, OnlyInTimeThatNothingElseNeeds) {
    Refinement refinement(0.5);
    EXPECT_FALSE(
        refinement.next({.rests = true, .plain_ms = 11, .dearer = 2, .budget_ms = 50}, kStart)); // 22 > 0.8 * 25
    EXPECT_TRUE(refinement.next({.rests = true, .plain_ms = 9, .dearer = 2, .budget_ms = 50}, kStart));
    EXPECT_TRUE(
        refinement.next({.rests = true, .plain_ms = 11, .dearer = 2, .budget_ms = 50}, kStart)); // once begun: 25
    EXPECT_FALSE(refinement.next({.rests = false, .plain_ms = 9, .dearer = 2, .budget_ms = 50}, kStart));
    EXPECT_FALSE(
        refinement.next({.rests = true, .plain_ms = 0, .dearer = 2, .budget_ms = 50}, kStart)); // not measured yet
}

// The prediction was wrong: it ends, and tries again after five seconds, not at every frame.
TEST(Refinement, EndsWhenItTakesMoreThanItMayAndPauses) {
    Refinement refinement(0.5);
    const Refinement::Observation seen{.rests = true, .plain_ms = 5, .dearer = 2, .budget_ms = 50};
    EXPECT_TRUE(refinement.next(seen, kStart));
    refinement.took(24);
    EXPECT_TRUE(refinement.next(seen, kStart));
    for (int i = 0; i < 10; ++i) refinement.took(40);
    EXPECT_FALSE(refinement.next(seen, kStart + milliseconds(100)));
    EXPECT_FALSE(refinement.next(seen, kStart + milliseconds(5000)));
    EXPECT_TRUE(refinement.next(seen, kStart + milliseconds(5100)));
}

TEST(Refinement, NoneWhenItMayTakeNothing) {
    Refinement refinement(0);
    EXPECT_FALSE(refinement.next({.rests = true, .plain_ms = 0.001, .dearer = 1, .budget_ms = 1000}, kStart));
}

TEST(History, PercentilesOfTheNewestFramesAndTheirRate) {
    History history;
    EXPECT_EQ(history.of(0).p99, 0);
    EXPECT_EQ(history.rate(kStart), 0);
    for (int i = 1; i <= 100; ++i) history.add({float(i), 2.0f * float(i), 0, 0, 0}, kStart + milliseconds(20 * i));
    EXPECT_FLOAT_EQ(history.of(0).p50, 50);
    EXPECT_FLOAT_EQ(history.of(0).p95, 95);
    EXPECT_FLOAT_EQ(history.of(1).p99, 198);
    EXPECT_NEAR(history.rate(kStart + milliseconds(2000)), 100 / 3.0, 0.1);
    EXPECT_EQ(history.rate(kStart + std::chrono::seconds(60)), 0);
    // More come than it holds: the old ones are forgotten, and the rate is that of those that are there.
    for (int i = 1; i <= 1000; ++i)
        history.add({7, 0, 0, 0, 0}, kStart + std::chrono::seconds(60) + milliseconds(5 * i));
    EXPECT_FLOAT_EQ(history.of(0).p50, 7);
    EXPECT_FLOAT_EQ(history.of(0).p99, 7);
    EXPECT_NEAR(history.rate(kStart + std::chrono::seconds(65)), 200, 2);
}

} // namespace
} // namespace brume::quality_test
