// Turns of frame loops on one device: parts in the ratio of weights, whatever a batch takes.
#include "server/loop/device_turns.h"

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace brume::device_turns_test {
namespace {

using namespace std::chrono_literals;
using Time = DeviceTurns::Time;

// Loops that draw as often as they may, by a clock of their own.
struct Loops {
    DeviceTurns turns;
    struct Loop {
        double weight;
        std::chrono::milliseconds batch;
        std::unique_ptr<DeviceTurns::Seat> seat{};
        std::chrono::milliseconds used{0};
        bool wants = true;
    };
    std::vector<Loop> loops;
    Time now{1000s};

    Loops(std::initializer_list<std::pair<double, std::chrono::milliseconds>> all) {
        for (const auto& [weight, batch] : all) {
            loops.push_back({weight, batch});
            loops.back().seat = std::make_unique<DeviceTurns::Seat>(turns, [] {});
        }
    }
    void runFor(std::chrono::milliseconds time) {
        Loop* drawing = nullptr;
        for (const Time end = now + time; now < end;) {
            for (Loop& loop : loops) // those who do not draw wait
                if (loop.wants && &loop != drawing && loop.seat->take(loop.weight, now)) drawing = &loop;
            if (!drawing) {
                now += 1ms;
                continue;
            }
            now += drawing->batch;
            drawing->used += drawing->batch;
            if (!drawing->wants || !drawing->seat->take(drawing->weight, now)) {
                drawing->seat->give(now);
                drawing = nullptr;
            }
        }
        if (drawing) drawing->seat->give(now);
    }
    double part(size_t number) const {
        double all = 0;
        for (const Loop& loop : loops) all += double(loop.used.count());
        return double(loops[number].used.count()) / all;
    }
    void forget() {
        for (Loop& loop : loops) loop.used = {};
    }
};

TEST(DeviceTurns, OneLoopAloneNeverWaits) {
    Loops alone{{1, 30ms}};
    alone.runFor(3000ms);
    EXPECT_GE(alone.loops[0].used, 3000ms);
    EXPECT_EQ(alone.loops[0].seat->part(alone.now), 1);
}

TEST(DeviceTurns, EqualWeightsHaveEqualParts) {
    Loops two{{1, 40ms}, {1, 5ms}};
    two.runFor(10'000ms);
    EXPECT_NEAR(two.part(0), 0.5, 0.01) << "however long one's batches are";
    EXPECT_EQ(two.loops[0].seat->part(two.now), 0.5);
}

TEST(DeviceTurns, PartsAreAsTheWeights) {
    Loops three{{5, 10ms}, {1, 30ms}, {4, 7ms}};
    three.runFor(30'000ms);
    EXPECT_NEAR(three.part(0), 0.5, 0.02);
    EXPECT_NEAR(three.part(1), 0.1, 0.02);
    EXPECT_NEAR(three.part(2), 0.4, 0.02);
}

TEST(DeviceTurns, WhoWantsNothingLeavesItsPartToTheOthers) {
    Loops two{{1, 10ms}, {1, 10ms}};
    two.loops[1].wants = false;
    two.runFor(5000ms);
    EXPECT_EQ(two.loops[1].used, 0ms);
    EXPECT_GE(two.loops[0].used, 4900ms);
    // And has no claim on what it did not want.
    two.loops[1].wants = true;
    two.forget();
    two.runFor(2000ms);
    EXPECT_NEAR(two.part(1), 0.5, 0.02);
}

TEST(DeviceTurns, WhoseTurnItIsAndDoesNotComeIsPassedOver) {
    DeviceTurns turns;
    DeviceTurns::Seat a(turns, [] {}), b(turns, [] {});
    Time now{1000s};
    ASSERT_TRUE(a.take(1, now));
    EXPECT_FALSE(b.take(1, now)); // it waits
    now += 10ms;
    a.give(now);
    EXPECT_FALSE(a.take(1, now)) << "it is the other's turn";
    now += 15ms;
    EXPECT_FALSE(a.take(1, now));
    now += 10ms;
    EXPECT_TRUE(a.take(1, now)) << "it did not come";
}

TEST(DeviceTurns, ThoseWhoWaitAreWokenWhenTheDeviceIsFree) {
    DeviceTurns turns;
    int woken = 0;
    DeviceTurns::Seat a(turns, [] {});
    std::optional<DeviceTurns::Seat> b(std::in_place, turns, [&] { ++woken; });
    const Time now{1000s};
    ASSERT_TRUE(a.take(1, now));
    a.give(now);
    EXPECT_EQ(woken, 0) << "it does not wait";
    ASSERT_TRUE(a.take(1, now));
    EXPECT_FALSE(b->take(1, now));
    a.give(now);
    EXPECT_EQ(woken, 1);
    ASSERT_TRUE(b->take(1, now));
    b.reset(); // with the device
    EXPECT_TRUE(a.take(1, now));
}

} // namespace
} // namespace brume::device_turns_test
