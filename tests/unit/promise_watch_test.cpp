// When the log says that render.error is broken.
#include <gtest/gtest.h>

#include "server/loop/promise_watch.h"

namespace brume::promise_watch_test {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;
using Time = PromiseWatch::Time;

constexpr double kPromised = 0.005;

ViewError measured(double low, uint32_t viewer = 3) {
    return {viewer, "slabs", {.pixels = 200, .rmse = 1.2 * low, .low = low, .high = 1.5 * low, .law = 0.004}};
}

class Promise : public testing::Test {
protected:
    PromiseWatch watch;
    const Time start = Time{} + seconds(1000);
    const ViewError above = measured(0.006), below = measured(0.0049);

    // True: it said that the promise is broken; false: that it holds again; nothing: nothing.
    std::optional<bool> at(milliseconds when, const ViewError* worst, bool relaxed = false,
                           double promised = kPromised) {
        const auto line = watch.look({promised, worst, relaxed}, start + when);
        if (!line) return {};
        EXPECT_FALSE(line->text.empty());
        return line->broken;
    }
};

TEST_F(Promise, ABrokenOneIsSaidAfterTwoSecondsAndOnce) {
    EXPECT_FALSE(at(milliseconds(0), &above));
    EXPECT_FALSE(at(milliseconds(1900), &above));
    const auto line = watch.look({kPromised, &above, false}, start + seconds(2));
    ASSERT_TRUE(line && line->broken);
    EXPECT_EQ(line->text,
              "pictures err more than render.error promises (0.5 %): viewer 3 sees 0.72 % (0.6 to 0.9) with "
              "slabs, predicted 0.4 %");
    EXPECT_FALSE(at(seconds(3), &above));
    EXPECT_FALSE(at(seconds(300), &above));
}

TEST_F(Promise, TheTwoSecondsAreWithoutAGap) {
    EXPECT_FALSE(at(seconds(0), &above));
    EXPECT_FALSE(at(seconds(1), &below));
    EXPECT_FALSE(at(seconds(2), &above));
    EXPECT_FALSE(at(seconds(3), nullptr));
    EXPECT_FALSE(at(seconds(5), &above));
    EXPECT_FALSE(at(milliseconds(6900), &above));
    EXPECT_EQ(at(seconds(7), &above), true);
}

TEST_F(Promise, WhenItHoldsAgainIsSaidOnce) {
    (void)at(seconds(0), &above);
    ASSERT_EQ(at(seconds(2), &above), true);
    EXPECT_EQ(at(seconds(3), &below), false);
    EXPECT_FALSE(at(seconds(4), &below));
}

TEST_F(Promise, NotMoreThanOnceAMinute) {
    (void)at(seconds(0), &above);
    ASSERT_EQ(at(seconds(2), &above), true);
    ASSERT_EQ(at(seconds(3), &below), false);
    (void)at(seconds(10), &above);
    EXPECT_FALSE(at(seconds(20), &above));
    EXPECT_FALSE(at(seconds(21), &below)) << "what was not said needs no end";
    (void)at(seconds(50), &above);
    EXPECT_EQ(at(seconds(62), &above), true);
}

TEST_F(Promise, OverloadBreaksNothing) {
    for (int s = 0; s <= 10; ++s) EXPECT_FALSE(at(seconds(s), &above, true));
    // Pictures of the overload are in the measurement for as long as it keeps them.
    EXPECT_FALSE(at(seconds(11), &above));
    EXPECT_FALSE(at(seconds(39), &above));
    EXPECT_FALSE(at(seconds(40), &above));
    EXPECT_EQ(at(seconds(42), &above), true);
}

TEST_F(Promise, AnotherPromiseIsJudgedByItsOwnPictures) {
    EXPECT_FALSE(at(seconds(0), &below, false, 0.05));
    EXPECT_FALSE(at(seconds(1), &above));
    EXPECT_FALSE(at(seconds(30), &above));
    EXPECT_FALSE(at(seconds(31), &above));
    EXPECT_EQ(at(seconds(33), &above), true);
}

TEST_F(Promise, ANamedMethodPromisesNothing) {
    for (int s = 0; s <= 100; s += 10) EXPECT_FALSE(at(seconds(s), &above, false, 0));
}

TEST(WorstError, IsOfTheMethodInUseAndKnown) {
    std::vector<ViewError> all{measured(0.002, 1), measured(0.003, 2), measured(0.9, 3), measured(0.8, 4)};
    all[2].method = "grid";
    all[3].error.pixels = ErrorEstimate::kLeast - 1;
    EXPECT_EQ(worstOf(all, "slabs")->viewer, 2u);
    EXPECT_EQ(worstOf(all, "grid")->viewer, 3u);
    EXPECT_FALSE(worstOf(all, "tiles"));
}

} // namespace
} // namespace brume::promise_watch_test
