// Whose pictures a batch draws, by a device that is made up and a clock that the test turns.
#include <algorithm>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "server/viewer/schedule.h"

namespace brume {
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
    Outcome out{std::vector<int>(costs.size()), std::vector<Clock::duration>(costs.size()), 0};
    std::vector<Clock::time_point> last(costs.size(), kStart);
    Clock::time_point now = kStart, drawn_tick{};
    while (now < kStart + ms(1000 * seconds)) {
        const Clock::time_point tick = kStart + (now - kStart) / kTick * kTick;
        const Clock::time_point next_tick = tick + kTick;
        if (tick == drawn_tick) { // once a tick
            now = next_tick;
            continue;
        }
        const auto chosen = schedule.choose(requests, {.budget_ms = budget_ms}, now, kTick);
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
// tick).
TEST(Schedule, OneThatIsDearDoesNotTakeTheOthersRate) {
    std::vector<double> costs(9, 2.0);
    costs[4] = 200;
    const Outcome out = run(costs, 50, 20);
    for (size_t i = 0; i < costs.size(); ++i) {
        if (i == 4) continue;
        EXPECT_GE(out.frames[i], 20 * 58 * 3 / 4)
            << i; // a fifth of the time is the dear one's, and what of a tick is left
        EXPECT_LT(out.longest[i], ms(200 + 2 * 17 + 17)) << i;
    }
    EXPECT_GE(out.frames[4], 15); // one a second, and what it waited for the batch before
    EXPECT_LT(out.longest[4], ms(1300));
}

// A picture of 900 ms cannot come once a second and leave much: it gets half of the time.
TEST(Schedule, HalfOfTheTimeIsTheOthersHoweverDearOneIs) {
    std::vector<double> costs(9, 2.0);
    costs[0] = 900;
    const Outcome out = run(costs, 50, 60);
    for (size_t i = 1; i < costs.size(); ++i) EXPECT_GE(out.frames[i], 60 * 58 / 2 * 9 / 10) << i;
    EXPECT_GE(out.frames[0], 60 / 2);
}

TEST(Schedule, AloneItGetsAllOfTheDevice) {
    const Outcome out = run({200.0}, 50, 20);
    EXPECT_GE(out.frames[0], 20'000 / (201 + 17));
}

// Whatever they cost and whatever the budget, nobody waits for more than all others' pictures and the second of its own
// turn.
TEST(Schedule, NobodyStarves) {
    for (const double budget : {1.0, 10.0, 50.0, 1000.0}) {
        const std::vector<double> costs{0.1, 90, 7, 7, 7, 30, 49, 51, 0.5, 0.5, 300, 3, 3, 20};
        const Outcome out = run(costs, budget, 60);
        const double all = std::accumulate(costs.begin(), costs.end(), double(costs.size()));
        for (size_t i = 0; i < costs.size(); ++i)
            EXPECT_LT(out.longest[i], ms(1000 + 3 * all)) << "viewer " << i << ", budget " << budget;
    }
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
} // namespace brume
