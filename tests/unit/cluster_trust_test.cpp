// Which NATS servers and which hosts a server of a cluster believes.
#include "server/cluster/trust.h"

#include <gtest/gtest.h>

namespace brume::cluster {
namespace {

TEST(ClusterTrust, TheHostOfAUrl) {
    EXPECT_EQ(hostOf("nats://a:b@Nats.Example:4222"), "nats.example");
    EXPECT_EQ(hostOf("nats://a:p@ss@h:1"), "h");
    EXPECT_EQ(hostOf("tls://[2001:DB8::1]:4222"), "2001:db8::1");
    EXPECT_EQ(hostOf("https://evil.example/a@cloud.example"), "evil.example");
    EXPECT_EQ(hostOf("https://evil.example?@cloud.example"), "evil.example");
    EXPECT_EQ(hostOf("https://cloud.example:1@evil.example"), "evil.example");
    EXPECT_EQ(hostOf("evil.example"), "");
    EXPECT_EQ(hostOf(""), "");
}

TEST(ClusterTrust, AServerThatOthersReachAsksWhoComes) {
    const auto open = [](const std::string& servers) { return openServer({.servers = servers}); };
    for (const char* fine : {"", "nats://127.0.0.1:4222", "nats://localhost:4222", "nats://[::1]:4222",
                             "nats://127.1.2.3", "nats://x:y@a", "nats://token@a:4222", "tls://x:y@a,nats://localhost"})
        EXPECT_EQ(open(fine), "") << fine;
    EXPECT_EQ(open("nats://10.0.0.7:4222"), "nats://10.0.0.7");
    EXPECT_EQ(open("nats://localhost,tls://nats.example:4222"), "tls://nats.example");
    EXPECT_EQ(open("nats://x:y@a,nats://b"), "nats://b");
    EXPECT_EQ(open("nats://x:@a"), "nats://a") << "an empty password is none";
    EXPECT_EQ(open("nats://127.0.0.1.evil.example"), "nats://127.0.0.1.evil.example");
    EXPECT_EQ(openServer({.servers = "nats://a", .credentials = "a.creds"}), "");
    EXPECT_EQ(openServer({.servers = "tls://a", .certificate = "a.pem", .key = "a.key"}), "");
}

TEST(ClusterTrust, ViewersGoToListedHostsAndToTheOwn) {
    const Hosts hosts("b.example,*.cloud.example,10.0.0.7,fd00::2", "https://A.example:8443/");
    for (const char* fine : {"https://a.example", "https://b.example:9/x", "wss://n3.cloud.example",
                             "http://10.0.0.7:8080", "http://[FD00::2]:1"})
        EXPECT_TRUE(hosts.allow(fine)) << fine;
    for (const char* not_fine :
         {"https://evil.example", "https://cloud.example", "https://notcloud.example", "", "http://10.0.0.70",
          "https://a.example.evil.example", "https://a.example@evil.example", "http://127.0.0.1", "b.example",
          R"(https://evil.example\@a.example)", R"(https://evil.example\.cloud.example)",
          "https://evil.example/\t@a.example", "https://evil.example\n.cloud.example", "https://x@a.example"})
        EXPECT_FALSE(hosts.allow(not_fine)) << not_fine;
    EXPECT_TRUE(Hosts("", "http://127.0.0.1:8081").allow("http://localhost:8082")) << "several on one machine";
    EXPECT_FALSE(Hosts("", "").allow("http://localhost:8082"));
}

} // namespace
} // namespace brume::cluster
