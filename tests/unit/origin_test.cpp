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

TEST(Origin, AnotherSitesPageIsTheListedOrNone) {
    const std::vector<std::string> listed{"https://a.example", "http://b.example:3000"};
    EXPECT_TRUE(siteAllowed("", "", "", {})) << "no browser, or one that does not say";
    for (const char* site : {"none", "same-origin", "same-site"})
        EXPECT_TRUE(siteAllowed(site, "https://evil.example", "", {})) << site;
    EXPECT_FALSE(siteAllowed("cross-site", "", "", listed));
    EXPECT_FALSE(siteAllowed("Cross-Site", "", "", listed));
    EXPECT_TRUE(siteAllowed("cross-site", "https://a.example", "", listed));
    EXPECT_FALSE(siteAllowed("cross-site", "http://a.example", "", listed));
    EXPECT_TRUE(siteAllowed("cross-site", "", "https://a.example/", listed));
    EXPECT_TRUE(siteAllowed("cross-site", "", "https://a.example/page?of=https://evil.example", listed));
    EXPECT_TRUE(siteAllowed("cross-site", "", "http://b.example:3000/x", listed));
    EXPECT_FALSE(siteAllowed("cross-site", "", "http://b.example/x", listed));
    EXPECT_FALSE(siteAllowed("cross-site", "", "https://evil.example/https://a.example/", listed));
    EXPECT_FALSE(siteAllowed("cross-site", "", "a.example", listed));
    EXPECT_FALSE(siteAllowed("cross-site", "https://evil.example", "https://a.example/", listed))
        << "the origin goes first";
    EXPECT_TRUE(siteAllowed("cross-site", "", "", {"*"}));
}

} // namespace
} // namespace brume::net
