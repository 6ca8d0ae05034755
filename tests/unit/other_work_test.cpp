// Whether others use the processors, by texts as Linux has them.
#include "common/other_work.h"

#include <gtest/gtest.h>

namespace brume {
namespace {

TEST(OtherWork, ReadsWhatLinuxWrites) {
    const CpuTicks ticks = readCpuTicks("cpu  100 20 30 4000 50 6 7 8 90 0\ncpu0 1 2 3 4\n",
                                        "12 (a) b (c) R 1 1 1 0 -1 4194304 99 0 0 0 250 30 5 6 20 0 1 0\n");
    EXPECT_EQ(ticks.passed, 100u + 20 + 30 + 4000 + 50 + 6 + 7 + 8);
    EXPECT_EQ(ticks.busy, 100u + 30 + 6 + 7 + 8) << "not what gives way, nor what waits for a disk";
    EXPECT_EQ(ticks.own, 280u);
    for (const char* text : {"", "cpu", "cpu ", "intr 1 2 3", "cpu  x"}) {
        EXPECT_EQ(readCpuTicks(text, "").passed, 0u);
        EXPECT_EQ(readCpuTicks(text, "1 (a) R").own, 0u);
        EXPECT_EQ(readCpuTicks("cpu  1 2 3 4 5 6 7 8", "1 (a) ").own, 0u);
    }
}

TEST(OtherWork, DisturbsWhereItTakesTimeFromThisProcess) {
    const auto disturbs = [](unsigned all, unsigned usable, double others, double own) { // cores
        const CpuTicks before{1'000'000, 300'000, 200'000};
        const CpuTicks now{before.passed + uint64_t(1000) * all, before.busy + uint64_t(1000 * (others + own)),
                           before.own + uint64_t(1000 * own)};
        return OtherWork(all, usable).disturbs(before, now);
    };
    EXPECT_FALSE(disturbs(2, 2, 0.1, 1.9));
    EXPECT_TRUE(disturbs(2, 2, 0.3, 1.7));
    EXPECT_TRUE(disturbs(2, 2, 1, 0.1)) << "a pass on two threads has one of them slower";
    EXPECT_FALSE(disturbs(64, 4, 59, 4)) << "of a large machine four cores are left";
    EXPECT_TRUE(disturbs(64, 4, 61, 3));
    EXPECT_FALSE(OtherWork(2, 2).disturbs({}, {1000, 1000, 0})) << "the first look";
    EXPECT_FALSE(OtherWork(2, 2).disturbs({1000, 0, 0}, {1000, 0, 0}));
}

TEST(OtherWork, OwnWorkDisturbsNobody) {
    OtherWork work;
    EXPECT_FALSE(work.disturbs()) << "the first look";
}

} // namespace
} // namespace brume
