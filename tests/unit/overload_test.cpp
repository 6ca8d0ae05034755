// When accuracy is given up and taken back, against a clock that the test turns.
#include <gtest/gtest.h>

#include "server/plan/overload.h"

namespace brume {
namespace {

// Frames of `ms` for `seconds`, twenty a second; how often the level changed.
int feed(Overload& overload, Overload::Time& now, double ms, double restored, double seconds) {
    int changes = 0;
    for (int i = 0; i < int(seconds * 20); ++i) {
        now += std::chrono::milliseconds(50);
        changes += overload.took(ms, restored, now);
    }
    return changes;
}

TEST(OverloadLevel, RisesAfterASecondAndFallsAfterFiveOfSpareTime) {
    Overload overload(33);
    Overload::Time now{std::chrono::hours(1)};
    EXPECT_EQ(feed(overload, now, 20, 1, 60), 0);
    EXPECT_EQ(feed(overload, now, 40, 1, 0.95), 0);
    EXPECT_EQ(feed(overload, now, 20, 1, 0.05), 0); // one short frame: not sustained
    EXPECT_EQ(feed(overload, now, 40, 1, 0.95), 0);
    EXPECT_EQ(feed(overload, now, 40, 1, 0.2), 1);
    EXPECT_EQ(overload.level(), 1u);
    EXPECT_EQ(feed(overload, now, 40, 1, 2.2), 2); // one by one
    EXPECT_EQ(overload.level(), 3u);
    EXPECT_EQ(feed(overload, now, 25, 1.5, 60), 0); // one level lower would take 37 ms
    EXPECT_EQ(feed(overload, now, 15, 1.5, 4.5), 0);
    EXPECT_EQ(feed(overload, now, 15, 1.5, 1), 1);
    EXPECT_EQ(overload.level(), 2u);
    EXPECT_EQ(feed(overload, now, 15, 1.5, 30), 2);
    EXPECT_EQ(overload.level(), 0u);
}

TEST(OverloadLevel, FallsOnAMachineThatIsBusyNowAndThen) {
    Overload overload(33);
    Overload::Time now{std::chrono::hours(1)};
    feed(overload, now, 40, 1, 1.2);
    ASSERT_EQ(overload.level(), 1u);
    for (int i = 0; i < 6; ++i) {
        feed(overload, now, 10, 1.5, 0.95);
        feed(overload, now, 40, 1.5, 0.05);
    }
    EXPECT_EQ(overload.level(), 0u);
}

// A step that saves more than is predicted looks as if it could be taken back, again and again.
TEST(OverloadLevel, DoesNotFlapWhereThePredictionIsWrong) {
    Overload overload(50);
    Overload::Time now{std::chrono::hours(1)};
    int changes = 0;
    for (int i = 0; i < 3600 * 20; ++i) {
        now += std::chrono::milliseconds(50);
        changes += overload.took(overload.level() == 0 ? 80 : 20, 1.5, now);
    }
    EXPECT_GE(changes, 5) << "it is tried again";
    EXPECT_LE(changes, 25);
    // Another load is another matter.
    feed(overload, now, 20, 1.5, 1300);
    ASSERT_EQ(overload.level(), 0u);
    feed(overload, now, 20, 1, 60);
    EXPECT_EQ(feed(overload, now, 80, 1.5, 1.2), 1);
    EXPECT_EQ(feed(overload, now, 20, 1.5, 5.2), 1);
}

TEST(OverloadLevel, ANewBudgetHoldsAtOnce) {
    Overload overload(33);
    Overload::Time now{std::chrono::hours(1)};
    overload.setBudget(100);
    EXPECT_EQ(feed(overload, now, 40, 1, 10), 0);
    overload.setBudget(20);
    EXPECT_GT(feed(overload, now, 40, 1, 2.2), 0);
}

TEST(OverloadLevel, APauseBetweenFramesIsNoOverload) {
    Overload overload(33);
    Overload::Time now{std::chrono::hours(1)};
    for (int i = 0; i < 20; ++i) { // a snapshot every two seconds
        now += std::chrono::seconds(2);
        EXPECT_FALSE(overload.took(100, 1, now));
    }
}

TEST(OverloadLevel, FramesOfMoreThanASecondAreOverload) {
    Overload overload(33);
    Overload::Time now{std::chrono::hours(1)};
    for (int i = 0; i < 3; ++i) { // one straight after the other
        now += std::chrono::milliseconds(1500);
        overload.took(1450, 1, now);
    }
    EXPECT_GT(overload.level(), 0u);
}

} // namespace
} // namespace brume
