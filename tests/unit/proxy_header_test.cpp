// The header by which a gateway says whose connection it passes on.
#include "server/net/proxy_header.h"

#include <gtest/gtest.h>

#include "tests/net/proxy_headers.h"

namespace brume::net {
namespace {

using test::addressesOf;
using test::binaryHeader;
using test::headerOf;

auto read(const std::string& bytes) {
    return readProxyHeader({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
}

// The address that a whole header gives, or what is wrong with it.
std::string sourceOf(const std::string& bytes) {
    const auto result = read(bytes);
    if (const auto* fault = std::get_if<ProxyFault>(&result)) return fault->line;
    if (const auto* more = std::get_if<ProxyMore>(&result)) return std::to_string(more->bytes) + " bytes more";
    EXPECT_EQ(std::get<ProxySource>(result).size, bytes.size());
    return std::get<ProxySource>(result).address;
}

const std::string kText = "PROXY TCP4 203.0.113.7 192.0.2.1 40000 8080\r\n";

TEST(ProxyHeader, TheBinaryOneGivesTheSource) {
    EXPECT_EQ(sourceOf(headerOf("203.0.113.7")), "203.0.113.7");
    EXPECT_EQ(sourceOf(headerOf("2001:db8::7")), "2001:db8::7");
    EXPECT_EQ(sourceOf(headerOf("203.0.113.7", std::string(300, 'x'))), "203.0.113.7") << "fields are skipped";
}

TEST(ProxyHeader, TheTextGivesTheSource) {
    EXPECT_EQ(sourceOf(kText), "203.0.113.7");
    EXPECT_EQ(sourceOf("PROXY TCP6 2001:DB8:0::7 ::1 1 65535\r\n"), "2001:db8::7") << "in its usual form";
    EXPECT_EQ(sourceOf("PROXY TCP4 255.255.255.255 255.255.255.255 65535 65535\r\n"), "255.255.255.255");
}

TEST(ProxyHeader, AGatewayThatSpeaksForItselfHasItsOwnAddress) {
    EXPECT_EQ(sourceOf(binaryHeader(0, 0, "")), "") << "LOCAL, as health checks are";
    EXPECT_EQ(sourceOf(binaryHeader(0, 0x11, addressesOf("203.0.113.7"))), "") << "whatever LOCAL says besides";
    EXPECT_EQ(sourceOf(binaryHeader(0, 0x7f, "rest")), "");
    EXPECT_EQ(sourceOf(binaryHeader(1, 0, "")), "") << "AF_UNSPEC";
    EXPECT_EQ(sourceOf("PROXY UNKNOWN\r\n"), "");
    EXPECT_EQ(sourceOf("PROXY UNKNOWN ffff::1 ffff::2 1 2\r\n"), "");
}

TEST(ProxyHeader, OtherFamiliesAreRefused) {
    for (const unsigned family : {0x12u, 0x22u, 0x31u, 0x32u, 0x10u, 0x01u, 0x41u})
        EXPECT_NE(sourceOf(binaryHeader(1, family, std::string(216, 'x'))).find("of a family"), std::string::npos)
            << family;
    EXPECT_NE(sourceOf("PROXY UDP4 203.0.113.7 192.0.2.1 40000 8080\r\n").find("of a family"), std::string::npos);
}

TEST(ProxyHeader, WhatIsNoneIsRefusedAtItsFirstWrongByte) {
    EXPECT_EQ(sourceOf("G"), kNoProxyHeader);
    EXPECT_EQ(sourceOf("PRI * HTTP/2.0"), kNoProxyHeader);
    EXPECT_EQ(sourceOf("\x16\x03\x01"), kNoProxyHeader);
    std::string damaged = headerOf("203.0.113.7");
    for (size_t at = 0; at < 12; ++at) {
        std::string one = damaged.substr(0, at + 1);
        one[at] ^= 1;
        EXPECT_EQ(sourceOf(one), kNoProxyHeader) << at;
    }
}

TEST(ProxyHeader, ABrokenOneIsRefused) {
    std::string version = headerOf("203.0.113.7"), command = version;
    version[12] = 0x11, command[12] = 0x22;
    for (const std::string& bad :
         {version, command, binaryHeader(1, 0x11, std::string(11, 'x')), binaryHeader(1, 0x21, std::string(35, 'x'))})
        EXPECT_NE(sourceOf(bad).find("that is broken"), std::string::npos);
    for (const std::string bad :
         {"PROXY TCP4 203.0.113.7 192.0.2.1 40000 8080\n", "PROXY TCP4 203.0.113.7 192.0.2.1 40000\r\n",
          "PROXY TCP4 203.0.113.7 192.0.2.1 40000 8080 1\r\n", "PROXY TCP4 203.0.113.7 192.0.2.1 40000 65536\r\n",
          "PROXY TCP4 203.0.113.7 192.0.2.1 04000 8080\r\n", "PROXY TCP4 203.0.113.7 192.0.2.1 4e3 8080\r\n",
          "PROXY TCP4 2001:db8::7 192.0.2.1 40000 8080\r\n", "PROXY TCP4 203.0.113.256 192.0.2.1 40000 8080\r\n",
          "PROXY TCP6 203.0.113.7 192.0.2.1 40000 8080\r\n", "PROXY TCP4 203.0.113.7 name 40000 8080\r\n",
          "PROXY TCP4  203.0.113.7 192.0.2.1 40000 8080\r\n", "PROXY TCP4 203.0.113.7 192.0.2.1\r 1 2\r\n"})
        EXPECT_NE(sourceOf(bad).find("that is broken"), std::string::npos) << bad;
}

TEST(ProxyHeader, ALongOneIsRefused) {
    EXPECT_EQ(sourceOf(headerOf("203.0.113.7", std::string(2048 - 28, 'x'))), "203.0.113.7");
    const std::string over = headerOf("203.0.113.7", std::string(2049 - 28, 'x'));
    EXPECT_NE(sourceOf(over.substr(0, 16)).find("more than 2048 bytes"), std::string::npos) << "before it is read";
    const std::string longest = "PROXY UNKNOWN " + std::string(91, 'x');
    EXPECT_EQ(sourceOf(longest + "\r\n"), "") << "107 bytes";
    EXPECT_NE(sourceOf(longest + "x").find("that is broken"), std::string::npos);
}

// Who reads what it asks for reads exactly the header, wherever it was cut before.
TEST(ProxyHeader, EveryBeginningAsksForNoMoreThanTheRest) {
    for (const std::string& header : {headerOf("203.0.113.7"), headerOf("2001:db8::7", "fields"),
                                      binaryHeader(0, 0, ""), binaryHeader(1, 0, "rest"), kText,
                                      std::string("PROXY TCP6 :: :: 1 2\r\n"), std::string("PROXY UNKNOWN\r\n")}) {
        const std::string expected = sourceOf(header);
        for (size_t size = 0; size < header.size(); ++size) {
            const auto result = read(header.substr(0, size));
            const auto* more = std::get_if<ProxyMore>(&result);
            ASSERT_TRUE(more) << size;
            EXPECT_GT(more->bytes, 0u);
            EXPECT_LE(size + more->bytes, header.size()) << size;
        }
        const auto followed = read(header + "GET / HTTP/1.1\r\n");
        ASSERT_TRUE(std::holds_alternative<ProxySource>(followed));
        EXPECT_EQ(std::get<ProxySource>(followed).size, header.size());
        EXPECT_EQ(std::get<ProxySource>(followed).address, expected);
    }
}

} // namespace
} // namespace brume::net
