// Whose pictures a batch draws, by a device that is made up and a clock that the test turns.
#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "server/viewer/schedule.h"

namespace brume::schedule_test {
namespace {

using Ms = std::chrono::duration<double, std::milli>;

const Clock::time_point kStart = Clock::time_point{} + std::chrono::hours(1);
constexpr auto kTick = std::chrono::microseconds(16667);

Clock::duration ms(double count) { return std::chrono::duration_cast<Clock::duration>(Ms(count)); }

// Wishes of viewers 0, 1, 2 ... with so many pixels each; a pixel takes 1 ms.
std::vector<Schedule::DrawRequest> requestsOf(const std::vector<double>& pixels) {
    std::vector<Schedule::DrawRequest> requests;
    for (uint32_t i = 0; i < pixels.size(); ++i) requests.push_back({.viewer = i, .pixels = pixels[i], .like = i});
    return requests;
}

struct Outcome {
    std::vector<int> frames;              // of each viewer
    std::vector<Clock::duration> longest; // between two of its frames
    int batches = 0;
};

// Every viewer wants a picture at every tick, for so many seconds, as FrameLoop asks for them.
Outcome run(const std::vector<double>& costs, double budget_ms, double seconds, double shared_ms = 1) {
    Schedule schedule;
    const auto requests = requestsOf(costs);
    std::vector<Schedule::DrawRequest> due;
    std::vector<bool> drawn(costs.size());
    schedule.expect(1);
    Outcome out{std::vector<int>(costs.size()), std::vector<Clock::duration>(costs.size()), 0};
    std::vector<Clock::time_point> last(costs.size(), kStart);
    Clock::time_point now = kStart, drawn_tick{};
    while (now < kStart + ms(1000 * seconds)) {
        const Clock::time_point tick = kStart + (now - kStart) / kTick * kTick;
        const Clock::time_point next_tick = tick + kTick;
        if (tick != drawn_tick) std::fill(drawn.begin(), drawn.end(), false);
        if (tick == drawn_tick && !schedule.someoneWaits()) { // once a tick
            now = next_tick;
            continue;
        }
        due.clear();
        for (const auto& request : requests)
            if (!drawn[request.viewer]) due.push_back(request);
        for (uint32_t i = 0; i < due.size(); ++i) due[i].like = i;
        std::vector<uint32_t> chosen;
        for (const uint32_t i : schedule.choose(due, {.budget_ms = budget_ms}, now, kTick))
            chosen.push_back(due[i].viewer);
        if (chosen.empty()) {
            now = next_tick;
            continue;
        }
        double took = shared_ms;
        for (const uint32_t i : chosen) took += costs[i];
        drawn_tick = tick;
        now += ms(took);
        ++out.batches;
        schedule.sharedTook(shared_ms);
        for (const uint32_t i : chosen) {
            schedule.took(i, costs[i], costs[i]);
            out.longest[i] = std::max(out.longest[i], now - last[i]);
            last[i] = now;
            drawn[i] = true;
            ++out.frames[i];
        }
    }
    for (size_t i = 0; i < last.size(); ++i) out.longest[i] = std::max(out.longest[i], now - last[i]);
    return out;
}

TEST(Schedule, EverybodyTogetherWhileThereIsTime) {
    const std::vector<double> sixteen(16, 3.0);
    const Outcome out = run(sixteen, 50, 5); // 49 ms a batch
    for (const int frames : out.frames) EXPECT_EQ(frames, out.batches);
}

// A batch costs once what its viewers share: what a budget is short of by little is not worth another one.
TEST(Schedule, ALittleOverTheBudgetIsStillOneBatch) {
    const Outcome out = run(std::vector<double>(16, 4.5), 50, 5); // 73 ms
    for (const int frames : out.frames) EXPECT_EQ(frames, out.batches);
}

TEST(Schedule, BeyondTheBudgetEqualsTakeTurns) {
    const Outcome out = run(std::vector<double>(16, 10.0), 50, 20); // 161 ms: four batches of four
    const auto [least, most] = std::minmax_element(out.frames.begin(), out.frames.end());
    EXPECT_LE(*most - *least, 2);
    EXPECT_GT(*least, 20'000 / (160 + 4) * 9 / 10); // nearly all of the time is theirs: 4 x 1 ms is shared
    for (const Clock::duration wait : out.longest) EXPECT_LT(wait, ms(2 * 170));
}

// One of 200 ms, eight of 2 ms. In one batch all would get 4.6 frames a second; alone, the eight get 58 (17 ms, once a
// tick). They demand 8 x 12 % of the device, so a ninth is the dear one's.
TEST(Schedule, OneThatIsDearDoesNotTakeTheOthersRate) {
    std::vector<double> costs(9, 2.0);
    costs[4] = 200;
    const Outcome out = run(costs, 50, 20);
    for (size_t i = 0; i < costs.size(); ++i) {
        if (i == 4) continue;
        EXPECT_GE(out.frames[i], 20 * 58 * 3 / 4) << i; // and what of a tick is left
        EXPECT_LT(out.longest[i], ms(200 + 2 * 17 + 17)) << i;
    }
    EXPECT_GE(out.frames[4], 10); // every 9 x 200 ms, and what it waited for the batch before
    EXPECT_LT(out.longest[4], ms(2100));
}

// What the others do not need is the dear one's: eight of 0.5 ms demand a quarter of the device.
TEST(Schedule, WhatOthersDoNotNeedIsTheDearOnes) {
    std::vector<double> costs(9, 0.5);
    costs[0] = 900;
    const Outcome out = run(costs, 50, 60);
    EXPECT_GE(out.frames[0], 60 * 0.7 * 1000 / 900);
    for (size_t i = 1; i < costs.size(); ++i) EXPECT_GE(out.frames[i], 60 * 58 / 5) << i;
}

// Equal time, not equal turns: 31 that take 240 ms each, and one of 5 ms.
TEST(Schedule, ASmallOneGetsItsPartOfTheTimeBesideManyDearOnes) {
    std::vector<double> costs(32, 240.0);
    costs[7] = 5;
    const Outcome out = run(costs, 50, 120);
    // Its part of the time is 6 frames a second. It gets one after each dear picture, which nothing interrupts: 4.1.
    EXPECT_GE(out.frames[7], 0.65 * 120 * 1000 / 32 / 5);
    EXPECT_LT(out.longest[7], ms(2 * (241 + 17)));
    for (size_t i = 0; i < costs.size(); ++i) {
        if (i != 7) {
            EXPECT_GE(out.frames[i], 0.8 * 120 / 32 * 1000 / 240) << i;
        }
    }
}

TEST(Schedule, AloneItGetsAllOfTheDevice) {
    const Outcome out = run({200.0}, 50, 20);
    EXPECT_GE(out.frames[0], 20'000 / (201 + 17));
}

// Whatever they cost and whatever the budget, nobody waits for more than its own turn among all, and twice all others'
// pictures.
TEST(Schedule, NobodyStarves) {
    for (const double budget : {1.0, 10.0, 50.0, 1000.0}) {
        const std::vector<double> costs{0.1, 90, 7, 7, 7, 30, 49, 51, 0.5, 0.5, 300, 3, 3, 20};
        const Outcome out = run(costs, budget, 60);
        const double all = std::accumulate(costs.begin(), costs.end(), double(costs.size()));
        for (size_t i = 0; i < costs.size(); ++i)
            EXPECT_LT(out.longest[i], ms(double(costs.size()) * costs[i] + 3 * all))
                << "viewer " << i << ", budget " << budget;
    }
}

// Frames of one viewer who stays, in `seconds`, beside four more. `churn`: they leave after each frame and come again
// as somebody else, and still ask while it is drawn.
int framesBeside(bool churn, double seconds) {
    Schedule schedule;
    constexpr double kCost = 38;
    auto requests = requestsOf(std::vector<double>(5, kCost));
    uint32_t next = 5;
    int frames = 0;
    std::vector<uint32_t> ids;
    for (Clock::time_point now = kStart; now < kStart + ms(1000 * seconds);) {
        ids.clear();
        for (const auto& request : requests) ids.push_back(request.viewer);
        std::sort(ids.begin(), ids.end());
        schedule.stay(ids);
        const auto chosen = schedule.choose(requests, {.budget_ms = 50}, now, kTick);
        now += ms(1 + kCost * double(chosen.size()));
        if (chosen.empty()) now += kTick;
        const std::vector<uint32_t> drawn(chosen.begin(), chosen.end());
        for (const uint32_t i : drawn) {
            schedule.took(requests[i].viewer, kCost, kCost);
            frames += i == 0;
            if (churn && i > 0) requests[i].viewer = next++;
        }
    }
    return frames;
}

TEST(Schedule, WhoComesAndGoesGetsNoMoreThanWhoStays) {
    const int steady = framesBeside(false, 20), beside_churn = framesBeside(true, 20);
    EXPECT_GE(steady, 20 * 1000 / (5 * 39) * 9 / 10);
    EXPECT_GE(beside_churn, 0.8 * steady);
}

TEST(Schedule, WhoHasLeftIsNotCounted) {
    Schedule schedule;
    const auto requests = requestsOf(std::vector<double>(41, 1.0));
    schedule.choose(requests, {.budget_ms = 50}, kStart, kTick);
    const std::vector<uint32_t> left{0, 1, 2, 3, 4};
    schedule.stay(left);
    schedule.choose({requests.data(), 5}, {.budget_ms = 50}, kStart + ms(20), kTick);
    EXPECT_EQ(schedule.active(), 5u);
}

// A first picture does not wait for those whose turn is far ahead.
TEST(Schedule, ANewcomerWaitsForItsPartOfTheTimeAtMost) {
    Schedule schedule;
    std::vector<double> costs(8, 400.0);
    auto requests = requestsOf(costs);
    for (Schedule::DrawRequest alone : requests) {
        alone.like = 0; // in a list of its own
        schedule.choose({&alone, 1}, {.budget_ms = 1000}, kStart, kTick);
        schedule.took(alone.viewer, 400, 400);
    }
    requests.push_back({.viewer = 8, .pixels = 5, .like = 8});
    const auto chosen = schedule.choose(requests, {.budget_ms = 50}, kStart + ms(100), kTick);
    ASSERT_EQ(chosen.size(), 1u); // it fits beside nobody, and nobody else's turn has come
    EXPECT_EQ(chosen[0], 8u);
}

// Pictures that are drawn alone share one seat, however many ask: they take their part of the time.
TEST(Schedule, PicturesThatAreDrawnAloneTakeTheirPartOfTheTime) {
    Schedule schedule;
    auto requests = requestsOf({20, 300});
    requests[1].alone = true;
    double alone_ms = 0, others_ms = 0;
    for (Clock::time_point now = kStart; now < kStart + ms(60'000);) {
        const auto chosen = schedule.choose(requests, {.budget_ms = 50}, now, kTick);
        if (chosen.empty()) {
            now += kTick;
            continue;
        }
        ASSERT_EQ(chosen.size(), 1u);
        const double took = requests[chosen[0]].pixels;
        (chosen[0] == 1 ? alone_ms : others_ms) += took;
        schedule.took(chosen[0], took, took, chosen[0] == 0);
        EXPECT_EQ(schedule.fullBatchMs(), now == kStart ? 0 : 20);
        now += ms(took);
    }
    EXPECT_NEAR(alone_ms / (alone_ms + others_ms), 0.5, 0.05);
}

TEST(Schedule, TheFairLevelIsWhereTheWaterStands) {
    EXPECT_EQ(fairLevel(std::vector<double>{0.1, 0.2}, 1), std::numeric_limits<double>::infinity());
    EXPECT_DOUBLE_EQ(fairLevel(std::vector<double>{1, 1, 1, 1}, 1), 0.25);
    EXPECT_DOUBLE_EQ(fairLevel(std::vector<double>{0.1, 0.3, 1, 1}, 1), 0.3);
    EXPECT_DOUBLE_EQ(fairLevel(std::vector<double>{0.1, 0.2, 1, 1}, 1), 0.35);
    EXPECT_DOUBLE_EQ(fairLevel(std::vector<double>{0, 0, 5}, 1), 1);
    EXPECT_EQ(fairLevel({}, 1), std::numeric_limits<double>::infinity());
    const double none = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(fairLevel(std::vector<double>{1, none}, 1), 0.5); // it ends
    EXPECT_EQ(fairLevel(std::vector<double>{1}, none), 0);
}

TEST(Schedule, WhoWasLeftOutComesFirst) {
    Schedule schedule;
    const auto requests = requestsOf({40, 40, 40});
    for (Schedule::DrawRequest alone : requests) {
        alone.like = 0; // the first of one
        schedule.choose({&alone, 1}, {.budget_ms = 50}, kStart, kTick);
    }
    for (uint32_t i = 0; i < 3; ++i) schedule.took(i, 40, 40);
    std::vector<uint32_t> turns;
    for (int i = 0; i < 6; ++i)
        for (const uint32_t number : schedule.choose(requests, {.budget_ms = 50}, kStart + ms(200 + 41 * i), kTick))
            turns.push_back(number);
    EXPECT_EQ(turns, (std::vector<uint32_t>{0, 1, 2, 0, 1, 2}));
    EXPECT_DOUBLE_EQ(schedule.fullBatchMs(), 120);
    EXPECT_DOUBLE_EQ(schedule.chosenMs(), 40);
}

// Viewers with the same camera share their pictures: they cost one.
TEST(Schedule, TheSamePicturesCountOnce) {
    Schedule schedule;
    auto requests = requestsOf({40, 40, 40, 40});
    for (Schedule::DrawRequest& request : requests) request.like = request.viewer % 2;
    schedule.choose(requests, {.budget_ms = 1000}, kStart, kTick);
    for (uint32_t i = 0; i < 4; ++i) schedule.took(i, 40, 40);
    const auto chosen = schedule.choose(requests, {.budget_ms = 50}, kStart + ms(500), kTick);
    EXPECT_EQ((std::vector<uint32_t>(chosen.begin(), chosen.end())), (std::vector<uint32_t>{0, 2}));
    EXPECT_DOUBLE_EQ(schedule.fullBatchMs(), 80);
}

TEST(Schedule, NoMoreEyesThanABatchHolds) {
    Schedule schedule;
    auto requests = requestsOf(std::vector<double>(40, 1.0));
    for (Schedule::DrawRequest& request : requests) request.eyes = 2;
    EXPECT_EQ(schedule.choose(requests, {.budget_ms = 50, .eyes = 64}, kStart, kTick).size(), 32u);
    EXPECT_EQ(schedule.choose(requests, {.budget_ms = 50, .eyes = 64}, kStart + ms(40), kTick).front(), 32u);
}

} // namespace
} // namespace brume::schedule_test
