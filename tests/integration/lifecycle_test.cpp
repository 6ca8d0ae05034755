// Starting, filling up, losing viewers and stopping; and every way in which starting fails.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

const Pose kPose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);

// A viewer gets in, after a few tries: the server may still be learning that the one before has gone.
bool admittedSoon(const RunningServer& server) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < deadline) {
        client::Session session(server.endpoint(), kSmall, kPatience);
        while (!session.closed() && !session.welcomed()) session.next(milliseconds(100));
        if (session.welcomed()) return true;
        std::this_thread::sleep_for(milliseconds(100));
    }
    return false;
}

TEST(Lifecycle, AFullHouseRefusesAndAVanishedViewerFreesItsPlace) {
    RunningServer server({"--max-viewers", "1"});
    Watcher first(server.endpoint());
    first.look(kPose);
    ASSERT_TRUE(watch({&first}, [&] { return first.frames.size() >= 2; }));

    client::Session second(server.endpoint(), kSmall, kPatience);
    bool full = false;
    while (!second.closed())
        if (const auto message = second.next(milliseconds(100)))
            if (const auto* error = message->as<wire::Error>()) full = error->code() == wire::ErrorCode::full;
    EXPECT_TRUE(full) << second.closedBecause();
    EXPECT_FALSE(second.welcomed());
    EXPECT_GT(second.retryAfterSeconds(), 0);
    const size_t before = first.frames.size();
    EXPECT_TRUE(watch({&first}, [&] { return first.frames.size() >= before + 2; }));

    first.session.connection().vanish();
    EXPECT_TRUE(admittedSoon(server));
}

TEST(Lifecycle, AViewerThatFallsSilentFreesItsPlace) {
    RunningServer server({"--max-viewers", "1", "--idle", "1000"});
    Watcher silent(server.endpoint()); // answers no ping, since nobody polls it
    silent.look(kPose);
    EXPECT_TRUE(admittedSoon(server));
}

TEST(Lifecycle, AConnectionThatNeverSaysHelloIsClosed) {
    RunningServer server({"--handshake", "300"});
    client::Connection mute(server.endpoint(), kPatience);
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    std::optional<std::string> goodbye;
    while (mute.state() != client::Connection::State::closed && std::chrono::steady_clock::now() < deadline)
        if (const auto message = mute.receive(milliseconds(100)))
            if (const auto parsed = wire::parse(*message))
                if (const auto* bye = parsed->as<wire::Goodbye>()) goodbye = bye->reason()->str();
    EXPECT_EQ(mute.state(), client::Connection::State::closed);
    ASSERT_TRUE(goodbye);
    EXPECT_NE(goodbye->find("Hello"), std::string::npos) << *goodbye;
}

TEST(Lifecycle, SigtermSaysGoodbyeAndExitsWithZero) {
    RunningServer server;
    Watcher a(server.endpoint()), b(server.endpoint());
    a.look(kPose);
    b.look(kPose);
    ASSERT_TRUE(watch({&a, &b}, [&] { return !a.frames.empty() && !b.frames.empty(); }));
    server.process().signal(SIGTERM);
    EXPECT_TRUE(watch(
        {&a, &b}, [&] { return a.goodbye && b.goodbye; }, milliseconds(10'000)));
    EXPECT_EQ(server.process().exitCode(milliseconds(10'000)), 0) << server.process().err();
}

TEST(Lifecycle, SigtermDoesNotWaitForAViewerThatReadsNothing) {
    RunningServer server;
    Watcher deaf(server.endpoint());
    deaf.look(kPose);
    ASSERT_TRUE(watch({&deaf}, [&] { return !deaf.frames.empty(); }));
    server.process().signal(SIGINT); // Ctrl-C stops it in the same way
    EXPECT_EQ(server.process().exitCode(milliseconds(15'000)), 0) << server.process().err();
}

// Nothing goes on, and one line says what is wrong: `word` is in it.
void expectOneLine(const std::vector<std::string>& arguments, const std::string& word) {
    SCOPED_TRACE(word);
    const auto process = startServer(arguments);
    const auto code = process->exitCode();
    ASSERT_TRUE(code) << "it goes on: " << process->out();
    EXPECT_GT(*code, 0) << "exited with 0 or was ended by a signal";
    const std::string err = process->err();
    // A driver without a cache may compile before, and the log says so.
    EXPECT_EQ(size_t(std::count(err.begin(), err.end(), '\n')), 1 + timesIn(err, "compiling shaders")) << err;
    EXPECT_NE(err.find(word), err.npos) << err;
    EXPECT_EQ(process->out().find("listening"), std::string::npos);
}

TEST(Lifecycle, EveryBadStartEndsInOneClearLine) {
    expectOneLine({"--no-such-flag"}, "--no-such-flag: no such option (see brume-server --help)");
    expectOneLine({"--prot", "8080"}, "--prot: no such option; did you mean --port?");
    expectOneLine({"--tls-cert", "a.pem"}, "--tls-cert: no such option; did you mean --tls-certificate?");
    expectOneLine({"--shadow-size", "64"},
                  "--shadow-size: no such option; did you mean --set render.shadow_size=VALUE?");
    expectOneLine({"--port", "70000"}, "--port");
    expectOneLine({"--max-viewers", "-1"}, "--max-viewers");
    expectOneLine({"--port", "0", "--scene", "no-such-scene"}, "no-such-scene");
    expectOneLine({"--port", "0", "--scene", "/dev/null/scene.toml"}, "/dev/null/scene.toml");
    expectOneLine({"--port", "0", "--method", "no-such-method"}, "no-such-method");
    expectOneLine({"--port", "0", "--listen", "300.0.0.1"}, "300.0.0.1");
    expectOneLine({"--port", "0", "--log-file", "/dev/null/log"}, "/dev/null/log");

    const auto pipe = std::filesystem::temp_directory_path() / ("brume-" + std::to_string(getpid()) + ".pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    expectOneLine({"--port", "0", "--log-file", pipe.string()}, "--log-file " + pipe.string() + ": is a pipe");
    expectOneLine({"--port", "0", "--tls-certificate", pipe.string(), "--tls-key", pipe.string()},
                  "--tls-certificate " + pipe.string() + ": is not a file");
    std::filesystem::remove(pipe);

    const auto scene = std::filesystem::temp_directory_path() / ("brume-" + std::to_string(getpid()) + ".toml");
    std::ofstream(scene) << "[medium]\nlayuot = 'cube'\n";
    expectOneLine({"--port", "0", "--scene", scene.string()}, scene.string() + ":2: medium.layuot");
    std::filesystem::remove(scene);
}

// A socket among them would keep the server's port after the server was killed.
TEST(Lifecycle, AProgramThatIsStartedHasNoneOfOurFiles) {
    const int ours = ::dup(STDERR_FILENO);
    const auto process =
        startProgram("/bin/sh", {"-c", "test ! -e /proc/$$/fd/" + std::to_string(ours) + " && test -e /proc/$$/fd/2"});
    EXPECT_EQ(process->exitCode(), 0);
    ::close(ours);
}

TEST(Lifecycle, FilesThatMayNotGrowAreToldOf) {
    const auto process =
        startProgram("/bin/sh", {"-c", "ulimit -f 1024; exec \"$0\" \"$@\"", BRUME_SERVER, "--port", "0"});
    test::expectOneLine(*process, "ulimit -f");
}

TEST(Lifecycle, ATakenPortEndsInOneClearLine) {
    RunningServer server;
    const std::string port = std::to_string(server.port());
    expectOneLine({"--scene", "cloud", "--port", port}, port);
    Watcher watcher(server.endpoint()); // the first one goes on
    watcher.look(kPose);
    EXPECT_TRUE(watch({&watcher}, [&] { return !watcher.frames.empty(); }));
}

TEST(Lifecycle, ExplainSaysThePlanOfEveryScene) {
    for (const std::string scene : {"plume", "cloud", "cloud-5000", "cumulus", "props", "tubes"}) {
        SCOPED_TRACE(scene);
        const auto process = startServer({"--scene", scene, "--explain", "--costs", "/nowhere"});
        EXPECT_EQ(process->exitCode(), 0) << process->err();
        const std::string out = process->out();
        for (const char* what :
             {"built in", "relative RMSE 0.5 %", "memory  ", "plan  ", "shadow volume", "taken", "sphere"})
            EXPECT_NE(out.find(what), out.npos) << what << '\n' << out;
        EXPECT_EQ(out.find("listening"), out.npos);
    }
}

TEST(Lifecycle, APointCloudIsToldOfAtTheStartAndForExplain) {
    const auto path = std::filesystem::temp_directory_path() / ("brume-cloud-" + std::to_string(getpid()));
    const std::string ply = path.string() + ".ply", scene = path.string() + ".toml";
    std::ofstream(ply) << "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                          "property float z\nproperty float nx\nend_header\n2000 0 0 1\n2001 0 0 1\n";
    std::ofstream(scene) << "[medium]\nlayout = 'file'\nfile = '" << path.filename().string()
                         << ".ply'\n[camera]\nposition = [0, 2, 26]\n";
    const auto expectTold = [&](const std::string& err) {
        for (const std::string& what :
             {"point cloud '" + ply + "': 2 points in [2000, 0, 0] to [2001, 0, 0] m; scale ",
              std::string("ignored properties: nx"), std::string("sees none of the 2 points")}) {
            const size_t at = err.find(what);
            EXPECT_NE(at, err.npos) << what << '\n' << err;
            EXPECT_EQ(err.find(what, at + 1), err.npos) << "once: " << err;
        }
    };
    const auto explained = startServer({"--scene", scene, "--explain", "--costs", "/nowhere"});
    EXPECT_EQ(explained->exitCode(), 0) << explained->err();
    expectTold(explained->err());
    RunningServer server({"--scene", scene});
    expectTold(server.process().err());
    std::filesystem::remove(ply);
    std::filesystem::remove(scene);
}

TEST(Lifecycle, APlannedServerShowsItsPlanInMetrics) {
    RunningServer server(
        {"--method", "auto", "--set", "render.error=0.01", "--frame-budget", "10000"}); // ms: nothing is given up
    Watcher watcher(server.endpoint());
    watcher.look(kPose);
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= 3; }));
    const auto error = metric(server.port(), "brume_plan_error"), relaxed = metric(server.port(), "brume_plan_relaxed");
    ASSERT_TRUE(error && relaxed);
    EXPECT_GT(*error, 0);
    EXPECT_LE(*error, 0.01); // what was asked for
    EXPECT_EQ(*relaxed, 0);
}

uintmax_t bytesIn(const std::filesystem::path& folder) {
    uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) bytes += entry.file_size();
    return bytes;
}

// What a driver's cache on disk does not get any more was there already: nobody waits for it to be compiled.
TEST(Lifecycle, WhatOverloadAndOtherViewersNeedIsCompiledAhead) {
    BRUME_WHOLE_LAYER_ONLY();
    const auto cache = std::filesystem::temp_directory_path() / ("brume-shaders-" + std::to_string(getpid()));
    std::filesystem::create_directory(cache);
    const std::vector<std::string> environment{"MESA_SHADER_CACHE_DIR=" + cache.string()};
    Process ahead({BRUME_SERVER, "--scene", "cloud", "--ahead", "only"}, environment);
    EXPECT_EQ(ahead.exitCode(std::chrono::minutes(5)), 0) << ahead.err();
    EXPECT_EQ(ahead.err(), "");
    std::istringstream said(ahead.out());
    size_t lines = 0;
    for (std::string line; std::getline(said, line);) {
        EXPECT_TRUE(line.starts_with("compiled ") || line.starts_with("pipeline ")) << line;
        lines += line.starts_with("compiled ");
    }
    EXPECT_GT(lines, 10u);
    if (bytesIn(cache) == 0) GTEST_SKIP() << "this driver keeps nothing there";
    // The plan's own rate, one that overload leads to; viewers of several sizes.
    for (const std::string rate : {"auto", "12"}) {
        Process server(
            {BRUME_SERVER, "--scene", "cloud", "--port", "0", "--ahead", "off", "--set", "render.rate=" + rate},
            environment);
        const auto port = server.lineStarting("listening on http://127.0.0.1:");
        ASSERT_TRUE(port) << server.err();
        const uintmax_t started = bytesIn(cache);
        for (const char* size : {"w=640&h=360", "w=320&h=180", "w=960&h=540"})
            if (rate == "auto" || std::string(size) == "w=640&h=360") {
                EXPECT_EQ(get(uint16_t(std::stoi(*port)), std::string("/snapshot.jpg?") + size).status, 200);
                EXPECT_EQ(bytesIn(cache), started) << "rate " << rate << ", " << size;
            }
    }
    std::filesystem::remove_all(cache);
}

bool runsSomewhere(const std::string& argument) {
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream in(entry.path() / "cmdline");
        const std::string all((std::istreambuf_iterator<char>(in)), {});
        if (all.find(argument) != all.npos && all.find("--ahead") != all.npos) return true;
    }
    return false;
}

TEST(Lifecycle, WhoCompilesAheadEndsWithTheServerHoweverThatEnds) {
    const std::string mark = "/nowhere/" + std::to_string(getpid()); // among its arguments, to be known by
    for (const int end : {SIGTERM, SIGKILL}) {
        Process server({BRUME_SERVER, "--scene", "props", "--port", "0", "--ahead", "background", "--costs", mark});
        ASSERT_TRUE(server.lineStarting("listening on ")) << server.err();
        const auto soon = [&](bool runs) {
            for (int i = 0; i < 1000; ++i) {
                if (runsSomewhere(mark) == runs) return true;
                std::this_thread::sleep_for(milliseconds(10));
            }
            return false;
        };
        EXPECT_TRUE(soon(true));
        server.signal(end);
        EXPECT_TRUE(server.exitCode());
        EXPECT_TRUE(soon(false));
    }
}

// Also those that have ended and whose end nobody asked for yet.
size_t childrenOf(pid_t parent) {
    size_t children = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream in(entry.path() / "stat"); // 1234 (name) S parent ...
        std::string all;
        std::getline(in, all);
        const size_t behind = all.rfind(") ");
        if (behind != all.npos && std::atoi(all.c_str() + behind + 4) == parent) ++children;
    }
    return children;
}

TEST(Lifecycle, WhoHasCompiledAheadIsGone) {
    BRUME_WHOLE_LAYER_ONLY();
    Process server({BRUME_SERVER, "--scene", "cloud", "--port", "0", "--ahead", "background", "--set",
                    "render.method=slabs", "--set", "render.rate=8"}); // few ways are compiled then
    ASSERT_TRUE(server.lineStarting("listening on ")) << server.err();
    const auto becomes = [&](size_t children, int seconds) {
        for (int i = 0; i < 200 * seconds; ++i) { // asked once each time: who compiles little is soon gone
            if (childrenOf(server.id()) == children) return true;
            std::this_thread::sleep_for(milliseconds(5));
        }
        return false;
    };
    EXPECT_TRUE(becomes(1, 30));
    EXPECT_TRUE(becomes(0, 300));
    server.signal(SIGTERM);
    EXPECT_EQ(server.exitCode(), 0) << server.err();
}

TEST(Lifecycle, HelpAndVersion) {
    for (const std::string flag : {"--help", "--version"}) {
        const auto process = startServer({flag});
        EXPECT_EQ(process->exitCode(), 0);
        EXPECT_NE(process->out().find(flag == "--help" ? "--scene" : "brume-server"), std::string::npos)
            << process->out();
        EXPECT_EQ(process->err(), "");
    }
}

} // namespace
} // namespace brume::test
