// Hosts, origins and sites that a request may name.
#include <gtest/gtest.h>

#include "server/net/origin.h"

namespace brume::net {
namespace {

TEST(Origin, AHostIsLocalAnAddressOrNamed) {
    NetOptions options;
    options.listen = "brume.example";
    options.hosts = {"clouds.example", "brume"};
    for (const char* host :
         {"localhost", "LocalHost:8080", "brume.localhost:1", "127.0.0.1", "127.0.0.1:8080", "192.0.2.7:80",
          "0.0.0.0:8080", "[::1]", "[::1]:8080", "[2001:db8::7]:443", "clouds.example", "Clouds.Example:8080",
          "brume:8080", "clouds.example:", "brume.example:8080"})
        EXPECT_TRUE(hostAllowed(host, options)) << host;
    for (const char* host : {"",
                             ":8080",
                             "evil.example",
                             "evil.example:8080",
                             "127.0.0.1.evil.example",
                             "notlocalhost",
                             "localhost.evil.example",
                             ".localhost.",
                             "clouds.example.evil.example",
                             "sub.clouds.example",
                             "127.0.0.1:8080:evil",
                             "127.0.0.1:http",
                             "127.1",
                             "2130706433",
                             "0x7f000001",
                             "::1",
                             "[::1",
                             "[",
                             "[]",
                             "[]:1",
                             "[::1]evil",
                             "[evil]:80",
                             "[127.0.0.1]",
                             "evil.example]:80",
                             "127.0.0.1@evil.example",
                             "127.0.0.1/",
                             " 127.0.0.1"})
        EXPECT_FALSE(hostAllowed(host, options)) << host;
}

TEST(Origin, APageIsOwnListedOrRefused) {
    const std::vector<std::string> listed{"https://a.example", "http://b.example:3000"};
    const auto may = [&](const Asker& asker) { return pageAllowed(asker, listed); };
    EXPECT_TRUE(may({})) << "no browser, or one that does not say";
    for (const char* site : {"none", "same-origin"}) EXPECT_TRUE(may({.site = site})) << site;
    EXPECT_FALSE(may({.site = "same-site"})) << "another port, or a name beside this one";
    EXPECT_FALSE(may({.site = "cross-site"}));
    EXPECT_FALSE(may({.site = "Cross-Site"}));
    EXPECT_TRUE(may({.referer = "https://a.example/", .site = "cross-site"}));
    EXPECT_TRUE(may({.referer = "https://a.example/page?of=https://evil.example", .site = "cross-site"}));
    EXPECT_TRUE(may({.referer = "http://b.example:3000/x", .site = "cross-site"}));
    EXPECT_FALSE(may({.referer = "http://b.example/x", .site = "cross-site"}));
    EXPECT_FALSE(may({.referer = "https://evil.example/https://a.example/", .site = "cross-site"}));
    EXPECT_FALSE(may({.referer = "a.example", .site = "cross-site"}));
    for (const char* site : {"", "cross-site", "same-site", "same-origin", "none"}) {
        EXPECT_TRUE(may({.host = "clouds:8080", .origin = "https://a.example", .site = site})) << site;
        EXPECT_FALSE(may({.host = "clouds:8080", .origin = "http://a.example", .site = site})) << site;
        EXPECT_FALSE(may({.host = "clouds:8080", .origin = "null", .site = site})) << site;
        EXPECT_FALSE(may({.host = "clouds:8080", .origin = "http://clouds:8081", .site = site})) << site;
        EXPECT_FALSE(may({.host = "clouds:8080", .origin = "http://clouds", .site = site})) << site;
        EXPECT_FALSE(may({.origin = "https://evil.example", .referer = "https://a.example/", .site = site}))
            << "the origin goes first";
    }
    EXPECT_TRUE(may({.host = "clouds:8080", .origin = "http://clouds:8080"}));
    EXPECT_TRUE(may({.host = "Clouds", .origin = "https://clouds:443"}));
    EXPECT_TRUE(may({.host = "clouds:80", .origin = "http://clouds"}));
    EXPECT_FALSE(may({.host = "clouds", .origin = "http://clouds", .site = "cross-site"}))
        << "the browser knows better";
    EXPECT_TRUE(pageAllowed({.origin = "null", .site = "cross-site"}, {"*"}));
    EXPECT_EQ(sharedWith("https://a.example", listed), "https://a.example");
    EXPECT_FALSE(sharedWith("https://evil.example", listed));
    EXPECT_FALSE(sharedWith("", {"*"}));
}

} // namespace
} // namespace brume::net
