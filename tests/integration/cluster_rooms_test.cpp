// Rooms of several servers: each is one cloud over all of them, apart from the others.
#include <csignal>

#include <gtest/gtest.h>

#include "server/cluster/engine.h"
#include "tests/free_port.h"
#include "tests/integration/cluster_node.h"
#include "tests/integration/program.h"
#include "tests/layer.h"

namespace brume::test::cluster_rooms {
namespace {

const client::Wishes kTiny{.width = 64, .height = 36, .views = 1, .quality = 80};
const std::vector<std::string> kLab{"--room", "lab=tubes", "--cluster-snapshot", "1"};

client::Endpoint labOf(const RunningServer& server) {
    client::Endpoint endpoint = server.endpoint();
    endpoint.path = "/r/lab/ws";
    return endpoint;
}

HttpReply post(uint16_t port, const std::string& target) {
    HttpConnection connection(port);
    connection.send("POST " + target + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n");
    return connection.readReply();
}

// Where a viewer is sent that finds no place.
std::string turnedAway(const client::Endpoint& room) {
    client::Session outside(room, kTiny, kPatience);
    while (!outside.closed() && outside.next(kPatience)) {
    }
    return outside.goTo();
}

class ClusterRooms : public testing::Test {
protected:
    std::vector<std::string> with(std::vector<std::string> more) const {
        more.insert(more.begin(), kLab.begin(), kLab.end());
        return inCluster(nats, std::move(more));
    }
    NatsServer nats;
};

TEST_F(ClusterRooms, ARoomIsOneOverAllServersAndApartFromTheOthers) {
    RunningServer first(with({})), second(with({}));
    Watcher home_a(first.endpoint(), kTiny), home_b(second.endpoint(), kTiny), lab_a(labOf(first), kTiny),
        lab_b(labOf(second), kTiny);
    const std::vector<Watcher*> all{&home_a, &home_b, &lab_a, &lab_b};
    for (Watcher* one : all) one->look(kFromFront);
    setExposure(lab_a, 2.5f);
    lab_b.session.sendImpulse({{0, 0, 26}, {0, 0, -1}, {0, 0, 0}, 5});
    ASSERT_TRUE(watch(all, [&] { return lab_a.exposure == 2.5f && lab_b.exposure == 2.5f; }));
    setExposure(home_b, 4);
    ASSERT_TRUE(watch(all, [&] { return home_a.exposure == 4 && home_b.exposure == 4; }));
    EXPECT_EQ(lab_a.exposure, 2.5f);
    EXPECT_EQ(lab_b.exposure, 2.5f);
    ASSERT_TRUE(watch(all, [&] { return commonHashes(home_a, home_b) >= 5 && commonHashes(lab_a, lab_b) >= 5; }));
    EXPECT_FALSE(firstDifference(home_a, home_b));
    EXPECT_FALSE(firstDifference(lab_a, lab_b));
    EXPECT_TRUE(firstDifference(home_a, lab_a) || commonHashes(home_a, lab_a) == 0) << "they are two clouds";
    EXPECT_EQ(count(first, "commands_total"), 1) << "of the scene at / alone";
    EXPECT_EQ(count(first, "commands_total{room=\"lab\"}"), 2);

    const HttpReply refused = post(first.port(), "/rooms/open?name=more&scene=cloud");
    EXPECT_EQ(refused.status, 422);
    EXPECT_EQ(refused.body, "one of several servers: their rooms are those that --room names\n");
    EXPECT_EQ(post(first.port(), "/rooms/close?name=lab").status, 422);

    // Who joins later has what was done in each room.
    RunningServer third(with({}));
    Watcher home_c(third.endpoint(), kTiny), lab_c(labOf(third), kTiny);
    home_c.look(kFromFront);
    lab_c.look(kFromFront);
    ASSERT_TRUE(watch({&home_a, &lab_a, &home_c, &lab_c}, [&] {
        return home_c.exposure == 4 && lab_c.exposure == 2.5f && commonHashes(home_a, home_c) >= 3 &&
               commonHashes(lab_a, lab_c) >= 3;
    }));
    EXPECT_FALSE(firstDifference(home_a, home_c));
    EXPECT_FALSE(firstDifference(lab_a, lab_c));
}

TEST_F(ClusterRooms, ViewersAreSentToTheSameRoom) {
    const std::string port = std::to_string(freePort()), url = "http://127.0.0.1:" + port; // without / at its end
    RunningServer other(with({"--port", port, "--cluster-url", url}));
    RunningServer full(with({"--max-viewers", "1", "--cluster-hosts", "127.0.0.1"}));
    Watcher home(full.endpoint(), kTiny), lab(labOf(full), kTiny);
    ASSERT_TRUE(watch({&home, &lab}, [&] { return home.state_tick > 120 && lab.state_tick > 120; }));
    EXPECT_EQ(turnedAway(full.endpoint()), url);
    EXPECT_EQ(turnedAway(labOf(full)), url + "/r/lab/");
    full.process().signal(SIGTERM);
    ASSERT_TRUE(watch({&home, &lab}, [&] { return home.go_to && lab.go_to; }));
    EXPECT_EQ(*home.go_to, url);
    EXPECT_EQ(*lab.go_to, url + "/r/lab/");
    const auto there = client::parseGoTo(*lab.go_to);
    ASSERT_TRUE(there);
    Watcher moved(*there, kTiny);
    EXPECT_TRUE(watch({&moved}, [&] { return moved.state_tick > 120; })) << "the room's ticks, where they were";
}

TEST_F(ClusterRooms, GoOnWhenTheLogIsBack) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer first(with({})), second(with({}));
    Watcher home(first.endpoint(), kTiny), lab_a(labOf(first), kTiny), lab_b(labOf(second), kTiny);
    const std::vector<Watcher*> all{&home, &lab_a, &lab_b};
    for (Watcher* one : all) one->look(kFromFront);
    ASSERT_TRUE(watch(all, [&] { return commonHashes(lab_a, lab_b) > 3; }));
    nats.kill();
    ASSERT_TRUE(watch(all, [&] { return !home.session.standstill().empty() && !lab_a.session.standstill().empty(); }));
    EXPECT_EQ(home.session.standstill(), lab_a.session.standstill());
    const uint64_t stood = std::max(lab_a.state_tick, lab_b.state_tick);
    nats.start();
    ASSERT_TRUE(watch(all, [&] {
        return home.session.standstill().empty() && lab_a.session.standstill().empty() &&
               commonHashes(lab_a, lab_b, stood + 1) > 3 && home.state_tick > stood;
    }));
    setExposure(lab_b, 3);
    ASSERT_TRUE(watch(all, [&] { return lab_a.exposure == 3; }));
    EXPECT_FALSE(firstDifference(lab_a, lab_b));
}

// Names of logs and rooms have the same letters: however they are put together, no two are one.
TEST_F(ClusterRooms, NoTwoShareALog) {
    const std::pair<const char*, const char*> names[] = {{"x", "a-b"}, {"x-a", "b"},   {"x-a-b", ""},   {"x_a", "b"},
                                                         {"x", "a_b"}, {"x_a_b", ""},  {"1_x_a_b", ""}, {"room-b", ""},
                                                         {"x", "log"}, {"x-log", "b"}, {"room", "b"}};
    for (const auto& [log, room] : names) {
        cluster::Engine engine({.servers = nats.url(), .log = log, .room = room}, [] {});
        const std::string own = std::string(log) + " of " + room;
        EXPECT_EQ(engine.open(own).about, own);
        EXPECT_FALSE(engine.get("state")) << own;
        engine.put("state", std::as_bytes(std::span(own)));
        EXPECT_EQ(engine.info()->last, 0u) << own;
        ASSERT_TRUE(engine.publish(own));
    }
}

TEST_F(ClusterRooms, ServersOfOtherRoomsAreToldApartInOneLine) {
    RunningServer first(with({"--max-viewers", "1", "--cluster-hosts", "127.0.0.1"}));
    const auto refused = startServer(inCluster(
        nats, {"--scene", "cloud", "--room", "lab=plume", "--port", "0", "--ahead", "off", "--log-level", "error"}));
    expectOneLine(*refused, "--room lab=plume: --cluster: the log 'cloud/lab' is of another scene");
    // One without the room is one of the servers, and no viewer of the room is sent there.
    const std::string port = std::to_string(freePort()), url = "http://127.0.0.1:" + port;
    RunningServer without(inCluster(nats, {"--port", port, "--cluster-url", url}));
    Watcher home(first.endpoint(), kTiny), lab(labOf(first), kTiny);
    ASSERT_TRUE(watch({&home, &lab}, [&] { return home.state_tick > 120 && lab.state_tick > 120; }));
    ASSERT_TRUE(waitFor(first, "nodes", 2));
    EXPECT_EQ(turnedAway(first.endpoint()), url);
    EXPECT_EQ(turnedAway(labOf(first)), "");
    const HttpReply none = get(without.port(), "/r/lab/ws");
    EXPECT_EQ(none.status, 404);
    EXPECT_EQ(none.body, "there is no such room: see /rooms\n");
}

// Without a name of the log it is the scene at "/" that names it.
TEST_F(ClusterRooms, OfAnotherSceneAtTheRootAreOthers) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer first(with({}));
    RunningServer beside(inCluster(nats, {"--scene", "plume", "--room", "lab=cloud"}));
    EXPECT_NE(beside.process().err().find("the log 'plume/lab'"), std::string::npos) << beside.process().err();
}

} // namespace
} // namespace brume::test::cluster_rooms
