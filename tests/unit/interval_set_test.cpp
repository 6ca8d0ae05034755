// The union of intervals that light meets behind balls; weights of six-way light maps; and how layers are put over each
// other.
#include "shaders/shared/interval_set.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "shaders/shared/six_way.h"

namespace brume::physics {
namespace {

using Pair = std::pair<double, double>;

template <class real>
IntervalSet<real> setOf(const std::vector<Pair>& intervals) {
    IntervalSet<real> set{};
    for (const auto& [begin, end] : intervals) addInterval(set, real(begin), real(end));
    return set;
}

double sortedLength(std::vector<Pair> intervals) {
    std::ranges::sort(intervals);
    double sum = 0, end = -1e30;
    for (const auto& [a, b] : intervals) {
        sum += std::max(b - std::max(a, end), 0.0);
        end = std::max(end, b);
    }
    return sum;
}

TEST(IntervalSet, NestedOnesCountOnceAndThoseApartAddUp) {
    EXPECT_EQ(lengthOf(setOf<double>({{1, 3}, {1.5, 2}, {1.2, 2.8}})), 2);
    EXPECT_EQ(lengthOf(setOf<double>({{4, 6}, {0, 1}})), 3);
    EXPECT_EQ(lengthOf(setOf<double>({{0, 1}, {1, 2}})), 2); // they touch: one part
    EXPECT_EQ(setOf<double>({{0, 1}, {1, 2}}).count, 1u);
    EXPECT_EQ(lengthOf(setOf<double>({{0, 1}, {4, 5}, {2, 3}, {0.5, 4.5}})), 5); // the last joins all
    EXPECT_EQ(lengthOf(setOf<double>({})), 0);
}

TEST(IntervalSet, AnyOrderGivesTheSameBits) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(0, 10), length(0, 1.5);
    for (int round = 0; round < 200; ++round) {
        std::vector<Pair> intervals;
        for (int i = 0; i < 25; ++i) {
            const double begin = place(random);
            intervals.emplace_back(begin, begin + length(random));
        }
        const IntervalSet<float> one = setOf<float>(intervals);
        ASSERT_EQ(one.fused, 0);
        EXPECT_NEAR(double(lengthOf(one)), sortedLength(intervals), 4e-6);
        EXPECT_NEAR(lengthOf(setOf<double>(intervals)), sortedLength(intervals), 1e-12);
        std::ranges::shuffle(intervals, random);
        const IntervalSet<float> other = setOf<float>(intervals);
        ASSERT_EQ(one.count, other.count);
        EXPECT_EQ(lengthOf(one), lengthOf(other));
        for (uint32_t i = 1; i < one.count; ++i) EXPECT_LT(one.ends[i - 1], one.begins[i]);
    }
}

TEST(IntervalSet, MorePartsThanItHasRoomForAreFusedAndCounted) {
    std::vector<Pair> intervals;
    for (uint32_t i = 0; i < kMostParts + 4; ++i) intervals.emplace_back(2 * i, 2 * i + 1);
    const IntervalSet<double> set = setOf<double>(intervals);
    EXPECT_EQ(set.count, kMostParts);
    EXPECT_EQ(set.fused, 4); // four intervals of length 1 found no room, each is a gap of 1 from its neighbour
    EXPECT_EQ(lengthOf(set) - set.fused, kMostParts + 4);
}

TEST(SixWay, WeightsAddUpToOneAndTheNearestSideIsTaken) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 d = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
        EXPECT_NEAR(sixWayLight(d, glm::dvec3(1), glm::dvec3(1)), 1, 1e-15);
    }
    const glm::dvec3 positive(1, 2, 3), negative(4, 5, 6);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 d(0);
        d[axis] = 1;
        EXPECT_EQ(sixWayLight(d, positive, negative), positive[axis]);
        EXPECT_EQ(sixWayLight(-d, positive, negative), negative[axis]);
    }
    double last = sixWayLight(glm::dvec3(1, 0, 0), positive, negative); // the camera rolls
    for (int degree = 1; degree <= 360; ++degree) {
        const double angle = degree * 3.14159265358979 / 180;
        const double now = sixWayLight(glm::dvec3(std::cos(angle), std::sin(angle), 0), positive, negative);
        EXPECT_LT(std::abs(now - last), 0.1) << degree;
        last = now;
    }
    EXPECT_NEAR(last, 1, 1e-12);
}

// Forty layers that emit their opacity, in a furnace of 1. Equation 4.1 of Mattsson (2022) keeps the transmittance of
// the last layer alone.
TEST(Compositing, AllLayersBeforeOneDimIt) {
    const double opacity = 0.3;
    double over = 0, through = 1, printed = 0, before = 0;
    for (int layer = 0; layer < 40; ++layer) {
        over += through * opacity;
        through *= 1 - opacity;
        printed += (1 - before) * opacity;
        before = opacity;
    }
    EXPECT_NEAR(over + through, 1, 1e-15);
    EXPECT_NEAR(printed, 8.49, 0.005);
}

} // namespace
} // namespace brume::physics
