// Somebody who can write to the log lies: no viewer is sent away, and no server ends.
#include <gtest/gtest.h>

#include "server/cluster/engine.h"
#include "server/cluster/message.h"
#include "server/cluster/node.h"
#include "tests/integration/cluster_node.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

constexpr const char* kLog = "lied-to";

class ClusterTrust : public testing::Test {
protected:
    ClusterTrust() { liar_.follow(1); }

    // Says that as many servers as there are letters in `names` are there, as the server `of` is but for what `change`
    // makes of it.
    template <class Change>
    void lie(const std::string& names, const Change& change) {
        std::vector<cluster::Stored> read;
        liar_.take(read);
        for (const cluster::Stored& stored : read) {
            const auto message = cluster::unpack(stored.text);
            if (!message || !std::holds_alternative<cluster::Here>(*message)) continue;
            cluster::Here here = std::get<cluster::Here>(*message);
            if (here.node.size() == 1) continue; // a lie
            change(here);
            for (const char name : names) liar_.publish(cluster::pack((here.node = name, here)));
        }
    }

    bool says(const char* words) { return server.process().err().find(words) != std::string::npos; }

    // Asks so seldom that the server does not refuse to answer.
    bool answersReady(int status) {
        std::this_thread::sleep_for(milliseconds(20));
        return get(server.port(), "/readyz").status == status;
    }

    NatsServer nats;
    RunningServer server{inCluster(nats, {"--cluster-name", kLog, "--max-viewers", "1", "--cluster-snapshot", "1"})};

private:
    cluster::Engine liar_{{.servers = nats.url(), .log = kLog}, [] {}};
};

TEST_F(ClusterTrust, ViewersGoToNoHostThatTheLogAloneNames) {
    Watcher inside(server.endpoint());
    inside.look(kFromFront);
    ASSERT_TRUE(watch({&inside}, [&] {
        lie("x", [](cluster::Here& here) { here.url = "https://evil.example/", here.load = 0, here.takes = true; });
        return says("evil.example");
    }));
    client::Session outside(server.endpoint(), kSmall, kPatience);
    while (!outside.closed() && outside.next(kPatience)) {
    }
    EXPECT_EQ(outside.goTo(), "");
}

// It is one against two. It goes on, takes no new viewers, and is one of the others again when nobody lies any more.
TEST_F(ClusterTrust, WhoIsOutvotedStandsAsideAndEndsNot) {
    BRUME_WHOLE_LAYER_ONLY(); // it waits for half a minute
    Watcher inside(server.endpoint());
    inside.look(kFromFront);
    const auto lies = [&](cluster::Here& here) { ++here.hash; };
    ASSERT_TRUE(watch({&inside}, [&] {
        lie("xy", lies);
        return says("stands aside");
    }));
    const uint64_t then = inside.state_tick;
    EXPECT_TRUE(watch({&inside}, [&] {
        lie("xy", lies);
        return inside.state_tick > then + 60;
    })) << "ticks go on";
    EXPECT_TRUE(watch({&inside}, [&] {
        lie("xy", lies);
        return answersReady(503);
    }));
    ASSERT_TRUE(watch({&inside}, [&] { return says("as the others again"); }));
    EXPECT_TRUE(watch({&inside}, [&] { return answersReady(200); }));
}

} // namespace
} // namespace brume::test
