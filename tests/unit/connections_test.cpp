// Room for connections: for all, for one address, and how often it may come.
#include <gtest/gtest.h>

#include "server/net/connections.h"

namespace brume::net {
namespace {

using Refused = Connections::Refused;
using Slot = std::unique_ptr<ConnectionSlot>;

TEST(Connections, RoomIsCountedForAllAndForEachAddress) {
    Connections connections({.total = 3, .per_address = 2});
    Refused why = Refused::nothing;
    Slot a = connections.take("a1", "a"), b = connections.take("a2", "a");
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->address(), "a1");
    EXPECT_FALSE(connections.take("a3", "a", &why)) << "one site";
    EXPECT_EQ(why, Refused::full);
    Slot c = connections.take("b", "b");
    ASSERT_TRUE(c);
    EXPECT_FALSE(connections.take("c", "c")) << "all";
    a.reset();
    EXPECT_TRUE(connections.take("a3", "a")) << "a slot is free again";
}

TEST(Connections, SomeAreKeptForWhoComesWhenAllAreTaken) {
    Connections connections({.total = 2, .per_address = 1, .reserve = 3, .reserve_per_address = 2});
    Slot a = connections.take("a", "a"), again = connections.take("a", "a"), b = connections.take("b", "b");
    ASSERT_TRUE(a && again && b);
    EXPECT_FALSE(a->reserved());
    EXPECT_TRUE(again->reserved()) << "all of its address are taken";
    EXPECT_FALSE(b->reserved()) << "the reserve takes no place from the others";
    Slot third = connections.take("a", "a");
    EXPECT_FALSE(connections.take("a", "a")) << "one address, of the reserve";
    Slot c = connections.take("c", "c");
    ASSERT_TRUE(third && c);
    EXPECT_TRUE(c->reserved()) << "all are taken";
    EXPECT_FALSE(connections.take("d", "d")) << "the reserve, too";
    b.reset();
    Slot d = connections.take("d", "d");
    EXPECT_TRUE(d && !d->reserved());
    d.reset();
    c.reset();
    EXPECT_TRUE(connections.take("a", "a") == nullptr) << "it still has two of the reserve";
    again.reset();
    again = connections.take("a", "a");
    EXPECT_TRUE(again && again->reserved());
}

TEST(Connections, OneAddressThatComesTooOftenKeepsNobodyElseOut) {
    Connections connections({.total = 1000, .per_address = 1000, .accept_rate = 0.001, .burst_s = 5000});
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(connections.take("a", "a"));
    Refused why = Refused::nothing;
    EXPECT_FALSE(connections.take("a", "a", &why));
    EXPECT_EQ(why, Refused::rate);
    EXPECT_TRUE(connections.take("b", "b"));
    connections.setLimits({.total = 1000, .per_address = 1000, .accept_rate = 1, .burst_s = 1});
    EXPECT_TRUE(connections.take("a", "a")) << "the new rate holds";
}

TEST(Connections, ThoseThatOweAHeaderAreBoundedAndApart) {
    Connections connections({.total = 1, .per_address = 1, .accept_rate = 1e-6, .burst_s = 1e6, .reserve = 2});
    Slot first = connections.takeOwing("a", "a"), second = connections.takeOwing("a", "a"),
         third = connections.takeOwing("a", "a");
    ASSERT_TRUE(first && second && third) << "one address, as often as it likes";
    EXPECT_FALSE(connections.takeOwing("b", "b")) << "as many as may be open, and those of the reserve";
    Slot known = connections.take("a", "a");
    ASSERT_TRUE(known);
    EXPECT_FALSE(known->reserved()) << "they take no place from the others";
    EXPECT_FALSE(connections.waitUntilEmpty({})) << "a stop waits for them";
    first.reset();
    EXPECT_TRUE(connections.takeOwing("b", "b"));
    second.reset(), third.reset(), known.reset();
    EXPECT_TRUE(connections.waitUntilEmpty({}));
}

// What is remembered of addresses does not grow with them: a bucket that is full again says nothing.
TEST(Connections, AddressesThatWentAreForgotten) {
    Connections connections({.total = 10, .per_address = 10, .accept_rate = 1e6, .burst_s = 1});
    for (int i = 0; i < 20'000; ++i) ASSERT_TRUE(connections.take("x", std::to_string(i))) << i;
    Connections flooded({.total = 10, .per_address = 10, .accept_rate = 1e-6, .burst_s = 1});
    int in = 0;
    for (int i = 0; i < 20'000; ++i) in += flooded.take("x", std::to_string(i)) != nullptr;
    EXPECT_LE(in, 4096) << "from everywhere at once: no more than are remembered";
    EXPECT_GE(in, 4000);
}

} // namespace
} // namespace brume::net
