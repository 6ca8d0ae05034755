// The engine of a cluster goes away, comes back, forgets: servers stand still, go on, load anew or end in one line.
#include <barrier>
#include <csignal>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include "server/cluster/engine.h"
#include "tests/integration/cluster_node.h"
#include "tests/integration/program.h"
#include "tests/layer.h"
#include "tests/net/certificate.h"

namespace brume::test {
namespace {

class ClusterEngine : public testing::Test {
protected:
    NatsServer nats;
};

// NATS tells those who come second that the name exists or that the subjects overlap, as it happens.
TEST_F(ClusterEngine, ManyOpenTheLogAtATimeAndFindTheSame) {
    constexpr int kEngines = 6, kTimes = 25;
    cluster::EngineOptions options;
    options.servers = nats.url();
    options.log = "shared";
    std::vector<std::unique_ptr<cluster::Engine>> engines;
    for (int i = 0; i < kEngines; ++i) engines.push_back(std::make_unique<cluster::Engine>(options, [] {}));
    std::barrier together(kEngines);
    for (int time = 0; time < kTimes; ++time) {
        std::vector<int64_t> created(kEngines, -1);
        {
            std::vector<std::jthread> threads;
            for (int i = 0; i < kEngines; ++i)
                threads.emplace_back([&, i] {
                    together.arrive_and_wait();
                    try {
                        created[i] = engines[i]->open("the scene").created;
                    } catch (const std::exception& error) {
                        ADD_FAILURE() << error.what();
                    }
                });
        }
        for (const int64_t one : created) EXPECT_EQ(one, created[0]);
        engines[0]->forget();
    }
}

TEST_F(ClusterEngine, WhileItIsAwayTicksStandAndCamerasGoOn) {
    RunningServer server(inCluster(nats));
    Watcher a(server.endpoint());
    a.look(kFromFront);
    ASSERT_TRUE(watch({&a}, [&] { return a.state_tick > 60 && !a.frames.empty(); }));
    nats.kill();
    ASSERT_TRUE(watch({&a}, [&] { return !a.session.standstill().empty(); }));
    EXPECT_NE(a.session.standstill().find("cannot be reached"), std::string::npos) << a.session.standstill();
    EXPECT_EQ(get(server.port(), "/readyz").status, 200);
    const uint64_t stood = a.last().tick;
    const uint32_t seq = a.look(lookAt({20, 2, 10}, {0, 0, 0}, 0.8f));
    ASSERT_TRUE(watch({&a}, [&] { return a.last().pose_seq == seq; })) << "a camera that moves gets pictures";
    EXPECT_EQ(a.last().tick, stood);
    setExposure(a, 3);
    ASSERT_TRUE(watch({&a}, [&] { return a.saw(wire::ErrorCode::busy); })) << "a command is answered";
    EXPECT_NE(a.errors.back().text.find("cannot be reached"), std::string::npos) << a.errors.back().text;

    nats.start();
    ASSERT_TRUE(watch({&a}, [&] { return a.session.standstill().empty() && a.state_tick > stood + 60; }));
    setExposure(a, 4);
    ASSERT_TRUE(watch({&a}, [&] { return a.exposure == 4; }));
    EXPECT_GT(metric(server.port(), "brume_cluster_standstill_seconds_total").value_or(0), 0);
}

TEST_F(ClusterEngine, WithAnEmptyStoreItIsAnotherLogAndServersEnd) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer server(inCluster(nats, {"--log-level", "error"}));
    Watcher a(server.endpoint());
    ASSERT_TRUE(watch({&a}, [&] { return a.state_tick > 60; }));
    nats.kill();
    std::filesystem::remove_all(nats.store());
    nats.start();
    expectOneLine(server.process(), "the log 'cloud' cannot be followed: it is gone");
}

// As after a power loss: what was answered is not there any more.
TEST_F(ClusterEngine, WithoutTheLogsEndServersLoadASnapshotAndAgree) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer first(inCluster(nats, {"--cluster-snapshot", "1"}));
    RunningServer second(inCluster(nats, {"--cluster-snapshot", "1"}));
    Watcher a(first.endpoint()), b(second.endpoint());
    a.look(kFromFront);
    b.look(kFromFront);
    ASSERT_TRUE(watch({&a, &b}, [&] { return a.state_tick > 100 && b.state_tick > 100; }));
    nats.kill();
    const auto copy = nats.store().string() + "-copy";
    std::filesystem::copy(nats.store(), copy, std::filesystem::copy_options::recursive);
    nats.start();
    const uint64_t copied = a.state_tick;
    ASSERT_TRUE(watch({&a, &b}, [&] { return a.session.standstill().empty() && a.state_tick > copied + 100; }));
    a.session.sendImpulse({{0, 0, 26}, {0, 0, -1}, {0, 0, 0}, 3});
    ASSERT_TRUE(watch({&a, &b}, [&] { return a.state_tick > copied + 160; }));
    nats.kill();
    std::filesystem::remove_all(nats.store());
    std::filesystem::rename(copy, nats.store());
    const auto forget = [](Watcher& watcher) { watcher.hashes.clear(); };
    ASSERT_TRUE(watch({&a, &b}, [&] { return !a.session.standstill().empty() && !b.session.standstill().empty(); }));
    forget(a);
    forget(b);
    nats.start();
    ASSERT_TRUE(watch({&a, &b}, [&] { return commonHashes(a, b) > 10; }));
    EXPECT_FALSE(firstDifference(a, b)) << *firstDifference(a, b);
    EXPECT_NE(first.process().err().find("lost its end"), std::string::npos) << first.process().err();
    setExposure(b, 3);
    ASSERT_TRUE(watch({&a, &b}, [&] { return a.exposure == 3 && b.exposure == 3; }));
}

TEST_F(ClusterEngine, MissingOrWithoutJetStreamIsToldInOneLine) {
    const std::vector<std::string> quiet{"--port", "0", "--scene", "cloud", "--cluster-timeout", "500"};
    const auto start = [&](const std::string& url) {
        std::vector<std::string> all = quiet;
        all.insert(all.end(), {"--cluster", url, "--log-level", "error"});
        return startServer(all);
    };
    expectOneLine(*start("nats://user:secret@127.0.0.1:1"), "--cluster nats://127.0.0.1:1: cannot connect");
    const NatsServer plain({"-m", "-1"});
    expectOneLine(*start(plain.url()), "JetStream");
    std::vector<std::string> more = quiet;
    more.insert(more.end(), {"--cluster", nats.url(), "--cluster-replicas", "3", "--log-level", "error"});
    expectOneLine(*startServer(more), "--cluster-replicas");
    expectOneLine(*startServer({"--cluster", "http://here"}), "allowed: nats://HOST:PORT");
    expectOneLine(*startServer({"--cluster", nats.url(), "--cluster-credentials", "/none"}), "credentials");
}

TEST_F(ClusterEngine, ItsCertificateAndAPasswordAreChecked) {
    const Certificate certificate;
    const std::filesystem::path store = nats.store().string() + "-tls";
    NatsServer guarded({"-js", "-sd", store.string(), "--user", "brume", "--pass", "pass-word", "--tls", "--tlscert",
                        certificate.certificate(), "--tlskey", certificate.key()});
    const std::string at = "127.0.0.1:" + std::to_string(guarded.port());
    const auto start = [&](const std::string& user, const std::vector<std::string>& more) {
        std::vector<std::string> all{"--port",      "0",    "--scene", "cloud", "--cluster", "tls://" + user + at,
                                     "--log-level", "error"};
        all.insert(all.end(), more.begin(), more.end());
        return startServer(all);
    };
    const std::vector<std::string> trusting{"--cluster-ca", certificate.certificate()};
    const auto stranger = start("brume:pass-word@", {});
    expectOneLine(*stranger, "self-signed certificate");
    EXPECT_EQ(stranger->err().find("pass-word"), std::string::npos) << "secrets are not told";
    expectOneLine(*start("brume:wrong@", trusting), "Authorization Violation");
    const auto welcome = start("brume:pass-word@", trusting);
    EXPECT_TRUE(welcome->lineStarting("listening on")) << welcome->err();
    std::filesystem::remove_all(store);
}

// NATS does not answer who asks for what is just being made. Here a rule forbids the question until it has been
// asked twice.
TEST_F(ClusterEngine, WhoJoinsAsksAgainForASnapshotThatDoesNotCome) {
    const std::string folder = nats.store().string() + "-asked", file = folder + ".conf";
    const auto forbid = [&](const std::string& what) {
        std::ofstream(file) << "jetstream { store_dir: '" << folder << "' }\n"
                            << "authorization { users: [{ user: brume, password: word,\n"
                            << "  permissions: { publish: { deny: [" << what << "] } } }] }\n";
    };
    forbid("'$JS.API.STREAM.MSG.GET.>', '$JS.API.DIRECT.GET.>'");
    NatsServer strict({"-c", file});
    const auto server = startServer({"--port", "0", "--scene", "cloud", "--log-level", "info", "--cluster",
                                     "nats://brume:word@127.0.0.1:" + std::to_string(strict.port())});
    const auto asked = [&] {
        const std::string log = strict.process().out(), refused = "Publish Violation";
        return log.find(refused, log.find(refused) + 1) != std::string::npos;
    };
    for (const auto deadline = std::chrono::steady_clock::now() + kPatience; !asked();) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline);
        ASSERT_FALSE(server->exitCode(milliseconds(50))) << server->err();
    }
    forbid("");
    strict.process().signal(SIGHUP);
    EXPECT_TRUE(server->lineStarting("listening on")) << server->err();
    std::filesystem::remove_all(folder);
    std::filesystem::remove(file);
}

TEST_F(ClusterEngine, AnewTheLogBeginsAtTheScenesStart) {
    BRUME_WHOLE_LAYER_ONLY();
    {
        RunningServer server(inCluster(nats));
        Watcher a(server.endpoint());
        setExposure(a, 3);
        ASSERT_TRUE(watch({&a}, [&] { return a.exposure == 3; }));
    }
    {
        RunningServer again(inCluster(nats));
        Watcher a(again.endpoint());
        EXPECT_TRUE(watch({&a}, [&] { return a.exposure == 3; })) << "a log outlives its servers";
    }
    RunningServer anew(inCluster(nats, {"--cluster-anew"}));
    Watcher a(anew.endpoint());
    ASSERT_TRUE(watch({&a}, [&] { return a.state_tick > 0; }));
    EXPECT_EQ(a.exposure, 1);
}

} // namespace
} // namespace brume::test
