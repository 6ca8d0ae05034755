// Places of streams and snapshots: for all, and for one owner.
#include <vector>

#include <gtest/gtest.h>

#include "server/net/places.h"

namespace brume::net {
namespace {

uint32_t shareOf(uint32_t most) {
    Places places("streams are open");
    std::vector<Places::Taken> taken;
    while (taken.empty() || taken.back().place) taken.push_back(places.take("a", most));
    return uint32_t(taken.size()) - 1;
}

TEST(Places, OneOwnerHasThreeQuartersAndOneAtLeast) {
    EXPECT_EQ(shareOf(0), 0u) << "none for anybody";
    EXPECT_EQ(shareOf(1), 1u);
    EXPECT_EQ(shareOf(2), 1u);
    EXPECT_EQ(shareOf(4), 3u);
    EXPECT_EQ(shareOf(8), 6u);
    EXPECT_EQ(shareOf(1000), 750u);
}

TEST(Places, AreGivenBackAndSaidToBeTaken) {
    Places places("streams are open");
    auto a = places.take("a", 2);
    EXPECT_EQ(places.take("a", 2).refusal, "1 streams are open for your address or token name, the most of 2");
    const auto b = places.take("b", 2);
    ASSERT_TRUE(a.place && b.place);
    EXPECT_EQ(places.take("c", 2).refusal, "2 streams are open, the most at a time");
    a.place.reset();
    EXPECT_TRUE(places.take("c", 2).place);
    EXPECT_TRUE(places.take("a", 2).place);
}

} // namespace
} // namespace brume::net
