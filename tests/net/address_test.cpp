// Addresses of peers, networks of them, and whose a request is that trusted proxies pass on.
#include <gtest/gtest.h>

#include "server/net/address.h"

namespace brume::test::address_test {
namespace {

using net::Address;
using net::Network;

bool holds(const char* network, const char* address) { return Network::read(network)->holds(*Address::read(address)); }

std::string whose(const char* peer, const std::vector<std::string_view>& lines,
                  const std::vector<const char*>& trusted = {"10.0.0.0/8", "2001:db8:ff::/48", "127.0.0.1"}) {
    std::vector<Network> networks;
    for (const char* one : trusted) networks.push_back(*Network::read(one));
    return net::forwardedFor(*Address::read(peer), lines, networks).text();
}

TEST(Address, ANetworkHoldsWhatBeginsLikeIt) {
    EXPECT_TRUE(holds("10.0.0.0/8", "10.255.0.1"));
    EXPECT_FALSE(holds("10.0.0.0/8", "11.0.0.1"));
    EXPECT_TRUE(holds("10.1.2.128/25", "10.1.2.200"));
    EXPECT_FALSE(holds("10.1.2.128/25", "10.1.2.127"));
    EXPECT_TRUE(holds("192.0.2.7", "192.0.2.7"));
    EXPECT_FALSE(holds("192.0.2.7", "192.0.2.6"));
    EXPECT_TRUE(holds("192.0.2.7", "::ffff:192.0.2.7")) << "as a listener of :: sees it";
    EXPECT_TRUE(holds("2001:db8::/32", "2001:db8:ffff::1"));
    EXPECT_FALSE(holds("2001:db8::/32", "2001:db9::1"));
    EXPECT_FALSE(holds("10.0.0.0/8", "2001:db8::1"));
    EXPECT_TRUE(holds("0.0.0.0/0", "203.0.113.9"));
    EXPECT_FALSE(holds("0.0.0.0/0", "2001:db8::1"));
    EXPECT_TRUE(holds("::/0", "203.0.113.9"));
}

TEST(Address, WhatIsNoNetworkIsNone) {
    for (const char* bad :
         {"", "/", "/8", "localhost", "10.0.0.0/33", "10.0.0.0/", "10.0.0.0/-1", "10.0.0.0/8x", "10.0.0.1/8",
          "::ffff:192.0.2.0/120", "2001:db8::/129", "2001:db8::1/32", "fe80::1%eth0", "10.0.0", " 10.0.0.1",
          "1111:2222:3333:4444:5555:6666:7777:8888:9999", "10.0.0.0/99999999999"})
        EXPECT_FALSE(Network::read(bad)) << bad;
}

TEST(Address, LimitsCountOneNetwork) {
    EXPECT_EQ(Address::read("203.0.113.7")->network(), "203.0.113.7");
    EXPECT_EQ(Address::read("::ffff:203.0.113.7")->network(), "203.0.113.7");
    EXPECT_EQ(Address::read("2001:db8:1:2:3:4:5:6")->network(), "2001:db8:1:2::/64");
}

TEST(Address, ARequestIsOfTheLastOneWhomATrustedProxyHeard) {
    EXPECT_EQ(whose("10.0.0.1", {"203.0.113.7"}), "203.0.113.7");
    EXPECT_EQ(whose("::ffff:10.0.0.1", {"203.0.113.7"}), "203.0.113.7");
    EXPECT_EQ(whose("10.0.0.1", {"192.0.2.1, 203.0.113.7"}), "203.0.113.7") << "what a visitor says comes first";
    EXPECT_EQ(whose("10.0.0.1", {"203.0.113.7, 10.0.0.2,10.0.0.3"}), "203.0.113.7") << "three proxies";
    EXPECT_EQ(whose("10.0.0.1", {"10.9.9.9, 203.0.113.7"}), "203.0.113.7") << "no visitor is a proxy by saying so";
    EXPECT_EQ(whose("10.0.0.1", {"192.0.2.1", "203.0.113.7"}), "203.0.113.7") << "lines are one list";
    EXPECT_EQ(whose("10.0.0.1", {"203.0.113.7", "10.0.0.2"}), "203.0.113.7");
    EXPECT_EQ(whose("10.0.0.1", {"10.0.0.3, 10.0.0.2"}), "10.0.0.3") << "a proxy's own";
    EXPECT_EQ(whose("10.0.0.1", {" 2001:db8::7\t"}), "2001:db8::7");
    EXPECT_EQ(whose("10.0.0.1", {"[2001:db8::7]:40000"}), "2001:db8::7");
    EXPECT_EQ(whose("10.0.0.1", {"203.0.113.7:40000"}), "203.0.113.7");
    EXPECT_EQ(whose("2001:db8:ff::1", {"::ffff:203.0.113.7"}), "203.0.113.7");
}

TEST(Address, WhoIsNotTrustedIsNotBelieved) {
    EXPECT_EQ(whose("203.0.113.9", {"192.0.2.1"}), "203.0.113.9");
    EXPECT_EQ(whose("10.0.0.1", {"192.0.2.1"}, {}), "10.0.0.1");
    EXPECT_EQ(whose("10.0.0.1", {}), "10.0.0.1");
}

TEST(Address, AnEntryThatIsNoAddressIsOfTheProxyThatWroteIt) {
    for (const char* bad : {"", ",", "unknown", "203.0.113", "203.0.113.7:x", "203.0.113.7:123456", "[2001:db8::7",
                            "[2001:db8::7]x", "fe80::1%eth0", "_hidden", "203.0.113.7 203.0.113.8"})
        EXPECT_EQ(whose("10.0.0.1", {bad}), "10.0.0.1") << bad;
    EXPECT_EQ(whose("10.0.0.1", {"192.0.2.1, unknown, 10.0.0.2"}), "10.0.0.2") << "nothing before it is believed";
    EXPECT_EQ(whose("10.0.0.1", {std::string_view("203.0.113.7\0", 12)}), "10.0.0.1");
}

} // namespace
} // namespace brume::test::address_test
