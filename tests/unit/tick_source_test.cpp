// When ticks are due, by a clock that the test turns.
#include <gtest/gtest.h>

#include "server/loop/tick_source.h"

namespace brume::tick_source_test {
namespace {

const Clock::time_point kStart = Clock::time_point{} + std::chrono::hours(1);

TEST(LocalTicks, AreSixtyASecondAndTakeTheCommandsOfTheirTime) {
    CommandQueue queue;
    LocalTicks ticks(queue, kStart);
    std::vector<Command> commands;
    EXPECT_FALSE(ticks.take(kStart - std::chrono::nanoseconds(1), commands));
    ASSERT_TRUE(queue.push({7, 1, Restart{}}));
    ASSERT_TRUE(ticks.take(kStart, commands));
    ASSERT_EQ(commands.size(), 1u);
    EXPECT_EQ(commands[0].viewer, 7u);
    EXPECT_EQ(ticks.due(), kStart + kTick);
    EXPECT_FALSE(ticks.take(kStart, commands));
    int taken = 1; // each tick once, however late it is asked for
    for (Clock::time_point now = kStart; now <= kStart + std::chrono::seconds(1); now += std::chrono::milliseconds(50))
        while (ticks.take(now, commands)) {
            EXPECT_TRUE(commands.empty());
            ++taken;
        }
    EXPECT_EQ(taken, 61);
}

TEST(LocalTicks, AStoppedProcessDoesNotFastForward) {
    CommandQueue queue;
    LocalTicks ticks(queue, kStart);
    std::vector<Command> commands;
    const Clock::time_point late = kStart + std::chrono::minutes(5);
    int taken = 0;
    while (ticks.take(late, commands)) ++taken;
    EXPECT_EQ(taken, 1);
    EXPECT_EQ(ticks.due(), late + kTick);
}

} // namespace
} // namespace brume::tick_source_test
