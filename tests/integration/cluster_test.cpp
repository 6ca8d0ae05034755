// Several servers, one cloud: what viewers of different servers see is one simulation, and servers come and go.
#include <csignal>

#include <gtest/gtest.h>

#include "tests/integration/cluster_node.h"
#include "tests/integration/program.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

class Cluster : public testing::Test {
protected:
    NatsServer nats;
};

TEST_F(Cluster, ViewersOfAllServersSeeTheSameTicksAndWhatAnyoneDoes) {
    RunningServer first(inCluster(nats)), second(inCluster(nats));
    Watcher a(first.endpoint()), b(second.endpoint());
    a.look(kFromFront);
    b.look(kFromFront);
    ASSERT_TRUE(watch({&a, &b}, [&] { return a.frames.size() > 2 && b.frames.size() > 2; }));
    for (int i = 0; i < 5; ++i) {
        a.session.sendImpulse({{0, 0, 26}, {0.01f * float(i), 0, -1}, {0, 0, 0}, 3});
        b.session.sendImpulse({{0, 0, 26}, {0, 0.01f * float(i), -1}, {0, 0, 0}, -3});
        setExposure(i % 2 ? a : b, 1.5f + float(i));
        ASSERT_TRUE(watch({&a, &b}, [&] { return a.exposure == 1.5f + float(i) && b.exposure == a.exposure; })) << i;
    }
    ASSERT_TRUE(watch({&a, &b}, [&] { return commonHashes(a, b) >= 10; }));
    EXPECT_FALSE(firstDifference(a, b)) << *firstDifference(a, b);
    EXPECT_TRUE(a.errors.empty() && b.errors.empty());
    EXPECT_EQ(count(first, "commands_total"), 15);
    EXPECT_EQ(count(second, "commands_total"), 15);
    EXPECT_EQ(count(first, "ticker") + count(second, "ticker"), 1);
}

// Both viewers have number 1, each at its server.
TEST_F(Cluster, ARefusalIsToldToWhoAskedAlone) {
    RunningServer first(inCluster(nats)), second(inCluster(nats));
    Watcher a(first.endpoint()), b(second.endpoint());
    a.session.sendCommand<wire::Remove>([](auto& builder) { return wire::CreateRemoveDirect(builder, "fog[7]"); });
    setExposure(b, 2);
    ASSERT_TRUE(watch({&a, &b}, [&] { return !a.errors.empty() && a.exposure == 2 && b.exposure == 2; }));
    EXPECT_NE(a.errors[0].text.find("fog[7]"), std::string::npos) << a.errors[0].text;
    EXPECT_TRUE(b.errors.empty());
}

TEST_F(Cluster, WhoJoinsLaterGoesOnFromASnapshot) {
    const std::vector<std::string> more{"--scene", "plume", "--cluster-snapshot", "1"};
    RunningServer first(inCluster(nats, more));
    Watcher a(first.endpoint());
    a.look(kFromFront);
    setExposure(a, 2.5f);
    a.session.sendImpulse({{0, 3, 26}, {0, 0, -1}, {0, 0, 0}, 5});
    ASSERT_TRUE(watch({&a}, [&] { return a.exposure == 2.5f && a.state_tick > 130; }));
    ASSERT_TRUE(waitFor(first, "snapshots_total", 3));
    RunningServer second(inCluster(nats, more));
    EXPECT_EQ(second.process().err().find("at tick 0 "), std::string::npos) << second.process().err();
    Watcher b(second.endpoint());
    b.look(kFromFront);
    ASSERT_TRUE(watch({&a, &b}, [&] { return commonHashes(a, b) >= 10 && b.exposure == 2.5f; }));
    EXPECT_FALSE(firstDifference(a, b));
}

TEST_F(Cluster, WhenTheTickerIsKilledAnotherGoesOn) {
    auto first = std::make_unique<RunningServer>(inCluster(nats));
    RunningServer second(inCluster(nats));
    ASSERT_TRUE(waitFor(second, "nodes", 2));
    Watcher a(first->endpoint()), b(second.endpoint());
    a.look(kFromFront);
    b.look(kFromFront);
    ASSERT_TRUE(watch({&a, &b}, [&] { return commonHashes(a, b) > 3; }));
    RunningServer& ticker = count(second, "ticker") == 1 ? second : *first;
    RunningServer& other = &ticker == &second ? *first : second;
    Watcher& left = &ticker == &second ? a : b;
    ticker.process().signal(SIGKILL);
    ASSERT_TRUE(waitFor(other, "ticker", 1)); // its viewer knows it up to a second later
    const uint64_t then = left.state_tick;
    ASSERT_TRUE(watch({&left}, [&] { return left.state_tick > then + 60; }));
    EXPECT_FALSE(firstDifference(a, b));
    setExposure(left, 4);
    EXPECT_TRUE(watch({&left}, [&] { return left.exposure == 4; }));
}

// It wakes up as the one that makes the ticks, and nobody listens to it.
TEST_F(Cluster, ATickerThatWasStoppedForSecondsComesBackAsAFollower) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer first(inCluster(nats)), second(inCluster(nats));
    ASSERT_TRUE(waitFor(second, "nodes", 2));
    Watcher a(first.endpoint()), b(second.endpoint());
    a.look(kFromFront);
    b.look(kFromFront);
    ASSERT_TRUE(watch({&a, &b}, [&] { return commonHashes(a, b) > 3; }));
    const bool first_ticks = count(first, "ticker") == 1;
    RunningServer& ticker = first_ticks ? first : second;
    Watcher &of_ticker = first_ticks ? a : b, &other = first_ticks ? b : a;
    ticker.process().signal(SIGSTOP);
    const uint64_t then = other.state_tick;
    ASSERT_TRUE(watch({&other}, [&] { return other.state_tick > then + 180; }));
    ticker.process().signal(SIGCONT);
    const uint64_t awake = other.state_tick;
    of_ticker.frames.clear();
    ASSERT_TRUE(watch({&a, &b}, [&] { return commonHashes(a, b, awake) > 5; }));
    EXPECT_FALSE(firstDifference(a, b));
    EXPECT_EQ(count(first, "divergences_total") + count(second, "divergences_total"), 0);
}

TEST_F(Cluster, AFullServerSendsViewersToAnother) {
    RunningServer second(inCluster(nats, {"--max-viewers", "8"}));
    const std::string url = "http://127.0.0.1:" + std::to_string(second.port());
    second.process().signal(SIGTERM); // its port is free, and it comes back with a URL
    ASSERT_TRUE(second.process().exitCode());
    RunningServer named(inCluster(nats, {"--port", std::to_string(second.port()), "--cluster-url", url}));
    RunningServer full(inCluster(nats, {"--max-viewers", "1", "--cluster-hosts", "127.0.0.1"}));
    ASSERT_TRUE(waitFor(full, "nodes", 2));
    Watcher inside(full.endpoint());
    ASSERT_TRUE(watch({&inside}, [&] { return inside.state_tick > 120; })); // the other has said what it has
    client::Session outside(full.endpoint(), kSmall, kPatience);
    while (!outside.closed() && outside.next(kPatience)) {
    }
    EXPECT_EQ(outside.goTo(), url);
}

TEST_F(Cluster, AnotherSceneOrSettingIsRefusedInOneLine) {
    RunningServer first(inCluster(nats, {"--cluster-name", "one"}));
    const auto refused = [&](std::vector<std::string> more, const std::string& words) {
        more.insert(more.end(), {"--port", "0", "--cluster-name", "one", "--log-level", "error"});
        const auto process = startServer(inCluster(nats, more));
        expectOneLine(*process, words);
    };
    refused({"--scene", "cloud", "--set", "medium.seed=5"}, "other particles or other --set");
    refused({"--scene", "plume"}, "another scene");
    RunningServer beside(inCluster(nats, {"--set", "medium.seed=5", "--cluster-name", "two"}));
    Watcher a(first.endpoint()), b(beside.endpoint());
    setExposure(b, 3);
    EXPECT_TRUE(watch({&a, &b}, [&] { return b.exposure == 3; }));
    EXPECT_EQ(a.exposure, 1) << "two logs are two clouds";
}

TEST_F(Cluster, ShowsNoOtherScene) {
    RunningServer server(inCluster(nats));
    HttpConnection connection(server.port());
    connection.send("POST /scene?name=plume HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n");
    const HttpReply reply = connection.readReply();
    EXPECT_GE(reply.status, 400);
    EXPECT_NE(reply.body.find("one of several servers"), std::string::npos) << reply.body;
}

} // namespace
} // namespace brume::test
