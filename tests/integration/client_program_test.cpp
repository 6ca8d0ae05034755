// brume-client itself, from its command line to its files.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::unique_ptr<Process> startClient(const std::vector<std::string>& arguments,
                                     const std::vector<std::string>& environment = {}) {
    return startProgram(BRUME_CLIENT, arguments, environment);
}

class ClientProgram : public testing::Test {
protected:
    static void SetUpTestSuite() { server_ = new RunningServer; }
    static void TearDownTestSuite() {
        delete server_;
        server_ = nullptr;
    }
    void SetUp() override {
        out_ = fs::temp_directory_path() / ("brume-client-" + std::to_string(getpid()));
        fs::remove_all(out_);
    }
    void TearDown() override { fs::remove_all(out_); }
    static std::string url() { return server_->url(); }
    Json stats() const { return Json::parse(contentOf(out_ / "stats.json")); }

    fs::path out_;

private:
    static inline RunningServer* server_ = nullptr;
};

// Returns once the only client of this server has presented frames: a server sends no third one before the first is
// acknowledged.
void waitForFrames(const RunningServer& server, double frames = 5) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (metric(server.port(), "brume_frames_total{fate=\"sent\"}").value_or(0) < frames) {
        if (std::chrono::steady_clock::now() >= deadline) throw std::runtime_error("the client gets no frames");
        std::this_thread::sleep_for(milliseconds(20));
    }
}

TEST_F(ClientProgram, FiveFramesAndTheirStatistics) {
    const auto client =
        startClient({"--headless", "--url", url(), "--size", "320x180", "--frames", "5", "--path", "orbit", "--camera",
                     "20,2,0,0,0,0", "--impulse", "0:0,0,26,0,0,-1,0.5", "--out", out_.string()});
    ASSERT_EQ(client->exitCode(), 0) << client->err();
    EXPECT_EQ(client->err(), "");
    EXPECT_NE(client->out().find("5 frames"), std::string::npos) << client->out();

    const Json s = stats();
    EXPECT_EQ(s["frames"], 5);
    EXPECT_EQ(s["url"], url() + "/ws");
    EXPECT_EQ(s["scene"], "cloud");
    EXPECT_EQ(s["ended"], "as asked");
    EXPECT_EQ(s["connections"], 1);
    EXPECT_EQ(s["inputs_sent"], 1);
    EXPECT_EQ(s["error_count"], 0) << s["errors"];
    EXPECT_GT(s["viewer"], 0);
    EXPECT_GT(s["frame_rate"], 0);
    for (const char* stage : {"total", "network", "wait", "render", "gpu", "encode", "queue", "decode"}) {
        const Json& latency = s["latency_ms"][stage];
        EXPECT_LE(latency["p50"], latency["p95"]) << stage;
        EXPECT_LE(latency["p95"], latency["p99"]) << stage;
    }
    EXPECT_GT(s["latency_ms"]["render"]["p50"], 0);
    EXPECT_GT(s["latency_ms"]["total"]["p50"], s["latency_ms"]["render"]["p50"]);

    ASSERT_EQ(s["pictures"].size(), 5u);
    uint64_t tick = 0, bytes = 0;
    for (size_t i = 0; i < 5; ++i) {
        const Json& picture = s["pictures"][i];
        EXPECT_GT(picture["tick"], tick);
        tick = picture["tick"];
        bytes += picture["bytes"].get<uint64_t>();
        EXPECT_EQ(picture["state_hash"].get<std::string>().size(), 18u);
        // A server that is slow at first sends smaller pictures of the same shape, but none below 160x90.
        const int width = picture["size"][0], height = picture["size"][1];
        EXPECT_TRUE(width >= 160 && width <= 320) << width;
        EXPECT_EQ(width * 9, height * 16);
        const auto& at = picture["pose"]["position"];
        EXPECT_NEAR(std::hypot(at[0].get<double>(), at[2].get<double>()), 20, 1e-3); // the circle that was asked for
        EXPECT_NEAR(at[1].get<double>(), 2, 1e-4);
        const client::Bytes jpeg = contentOf(out_ / ("frame-0000" + std::to_string(i + 1) + ".jpg"));
        EXPECT_GT(contrast(decoded(jpeg, width, height)), 8);
    }
    EXPECT_EQ(s["bytes"], bytes);
    EXPECT_EQ(std::distance(fs::directory_iterator(out_), {}), 6);
}

// Pictures of one state from many sides.
TEST_F(ClientProgram, PausedItSeesOneState) {
    const RunningServer server;
    const auto client = startClient({"--headless", "--pause", "--url", server.url(), "--size", "160x96", "--frames",
                                     "6", "--path", "orbit", "--out", out_.string()});
    ASSERT_EQ(client->exitCode(), 0) << client->err();
    const Json pictures = stats()["pictures"];
    ASSERT_EQ(pictures.size(), 6u);
    const auto sideOf = [](const Json& picture, int axis) { return picture["pose"]["position"][axis].get<double>(); };
    const double radius = std::hypot(sideOf(pictures[0], 0), sideOf(pictures[0], 2));
    const double start = std::atan2(sideOf(pictures[0], 0), sideOf(pictures[0], 2));
    for (size_t i = 0; i < pictures.size(); ++i) {
        const double angle = start + double(i) * std::numbers::pi / 3; // sixths of a round, however long each took
        EXPECT_EQ(pictures[i]["state_hash"], pictures[0]["state_hash"]) << i;
        EXPECT_NEAR(sideOf(pictures[i], 0), radius * std::sin(angle), 1e-3) << i;
        EXPECT_NEAR(sideOf(pictures[i], 2), radius * std::cos(angle), 1e-3) << i;
    }
}

TEST_F(ClientProgram, APausedSceneIsNoLostConnection) {
    RunningServer server({"--paused"});
    for (const bool window : {false, true}) {
        std::vector<std::string> arguments{"--url", server.url(), "--timeout", "2", "--seconds", "5"};
        if (!window) arguments.push_back("--headless");
        const auto client = startClient(arguments, {"SDL_VIDEODRIVER=dummy"});
        EXPECT_EQ(client->exitCode(), 0);
        EXPECT_EQ(client->err(), "") << (window ? "window" : "headless");
    }
}

TEST_F(ClientProgram, StereoWritesBothEyes) {
    const auto client = startClient({"--headless", "--stereo", "--url", url(), "--size", "160x96", "--frames", "2",
                                     "--quality", "55", "--out", out_.string()});
    ASSERT_EQ(client->exitCode(), 0) << client->err();
    for (const char* name :
         {"frame-00001-left.jpg", "frame-00001-right.jpg", "frame-00002-left.jpg", "frame-00002-right.jpg"})
        EXPECT_GT(contrast(decoded(contentOf(out_ / name), 160, 96)), 8) << name;
    EXPECT_EQ(stats()["pictures"][0]["views"], 2);
    EXPECT_EQ(stats()["pictures"][0]["quality"], 55);
    EXPECT_EQ(std::distance(fs::directory_iterator(out_), {}), 5);
}

TEST_F(ClientProgram, CtrlCEndsTidilyWithStatistics) {
    const RunningServer server;
    const auto client =
        startClient({"--headless", "--url", server.url(), "--size", "160x96", "--out", out_.string(), "--no-save"});
    waitForFrames(server);
    client->signal(SIGINT);
    EXPECT_EQ(client->exitCode(milliseconds(10'000)), 0) << client->err();
    EXPECT_EQ(client->err(), "");
    EXPECT_GT(stats()["frames"], 0);
    EXPECT_EQ(std::distance(fs::directory_iterator(out_), {}), 1);
}

TEST_F(ClientProgram, AServerThatStopsEndsInOneLineAndStatistics) {
    RunningServer server;
    const auto client = startClient({"--headless", "--no-reconnect", "--url", server.url(), "--size", "160x96", "--out",
                                     out_.string(), "--no-save"});
    waitForFrames(server);
    server.process().signal(SIGTERM);
    expectOneLine(*client, "goodbye");
    EXPECT_GT(stats()["frames"], 0);
}

TEST_F(ClientProgram, AServerThatDiesEndsInOneLine) {
    RunningServer server;
    const auto client = startClient({"--headless", "--no-reconnect", "--url", server.url(), "--size", "160x96"});
    waitForFrames(server);
    server.process().signal(SIGKILL);
    expectOneLine(*client, "lost");
}

TEST_F(ClientProgram, AFullServerEndsInOneLine) {
    RunningServer server({"--max-viewers", "1"});
    Watcher first(server.endpoint());
    expectOneLine(*startClient({"--headless", "--no-reconnect", "--url", server.url(), "--frames", "1"}), "refuses");
}

// One line says so, and how long it waits.
bool saysThatItTriesAgain(const Process& client, const std::string& why) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (client.err().find('\n') == std::string::npos && std::chrono::steady_clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(20));
    const std::string line = client.err();
    return line.find(why) != line.npos && line.find("; trying again in ") != line.npos;
}

TEST_F(ClientProgram, AFullServerIsAskedAgainWhenItSaid) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer server({"--max-viewers", "1"});
    Watcher first(server.endpoint());
    const auto client = startClient({"--headless", "--url", server.url(), "--frames", "2", "--size", "160x96"});
    ASSERT_TRUE(saysThatItTriesAgain(*client, "every place is taken")) << client->err();
    first.session.leave("done");
    EXPECT_EQ(client->exitCode(), 0) << client->err();
}

TEST_F(ClientProgram, AKilledServerThatComesBackIsWatchedOnFromTheSamePlace) {
    auto server = std::make_unique<RunningServer>();
    const std::string port = std::to_string(server->port());
    const auto client =
        startClient({"--headless", "--url", server->url(), "--size", "160x96", "--out", out_.string(), "--no-save"});
    waitForFrames(*server);
    server->process().signal(SIGKILL);
    ASSERT_TRUE(saysThatItTriesAgain(*client, "was lost")) << client->err();
    ASSERT_TRUE(server->process().exitCode());
    server =
        std::make_unique<RunningServer>(std::vector<std::string>{"--port", port, "--set", "camera.position=[9,9,9]"});
    waitForFrames(*server);
    client->signal(SIGINT);
    EXPECT_EQ(client->exitCode(), 0) << client->err();
    const std::string err = client->err();
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << "one line for all tries: " << err;

    const Json s = stats();
    EXPECT_EQ(s["ended"], "as asked");
    EXPECT_EQ(s["connections"], 2);
    EXPECT_EQ(s["resumed"], 0) << "the new server knows nobody";
    ASSERT_GE(s["pictures"].size(), 6u); // three of each server at least were acknowledged
    for (const Json& picture : s["pictures"])
        EXPECT_EQ(picture["pose"]["position"], Json({0, 2, 26})); // of the first server
}

TEST_F(ClientProgram, AViewerWhoseConnectionIsLostIsTheSameAgain) {
    const RunningServer server({"--idle", "500"}); // ms
    const auto client = startClient({"--headless", "--url", server.url(), "--size", "160x96", "--path", "orbit",
                                     "--out", out_.string(), "--no-save"});
    waitForFrames(server);
    client->signal(SIGSTOP); // a machine that sleeps
    const auto viewers = [&] { return metric(server.port(), "brume_viewers").value_or(-1); };
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (viewers() != 0 && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(milliseconds(20));
    ASSERT_EQ(viewers(), 0);
    const double sent = metric(server.port(), "brume_frames_total{fate=\"sent\"}").value_or(0);
    client->signal(SIGCONT);
    waitForFrames(server, sent + 5);
    client->signal(SIGINT);
    EXPECT_EQ(client->exitCode(), 0) << client->err();
    EXPECT_EQ(stats()["connections"], 2);
    EXPECT_EQ(stats()["resumed"], 1);
}

TEST_F(ClientProgram, TheNextOfSeveralServersIsTriedAtOnceWhenOneIsLost) {
    auto one = std::make_unique<RunningServer>();
    const RunningServer two({"--set", "camera.position=[9,9,9]"});
    const auto client = startClient(
        {"--headless", "--url", one->url() + "," + two.url(), "--size", "160x96", "--out", out_.string(), "--no-save"});
    waitForFrames(*one);
    one->process().signal(SIGKILL);
    waitForFrames(two);
    client->signal(SIGINT);
    EXPECT_EQ(client->exitCode(), 0) << client->err();
    EXPECT_NE(client->err().find("was lost: "), std::string::npos) << client->err();
    EXPECT_NE(client->err().find("; trying " + two.url() + "/ws in 0.0 s\n"), std::string::npos) << client->err();
    const Json s = stats();
    EXPECT_EQ(s["connections"], 2);
    EXPECT_EQ(s["resumed"], 0) << "nobody knows it there";
    for (const Json& picture : s["pictures"]) EXPECT_EQ(picture["pose"]["position"], Json({0, 2, 26}));
}

TEST_F(ClientProgram, AServerThatIsNotThereIsNoneOfSeveral) {
    const auto client =
        startClient({"--headless", "--url", "ws://127.0.0.1:1," + url(), "--size", "160x96", "--frames", "2"});
    EXPECT_EQ(client->exitCode(), 0) << client->err();
    const auto nobody = startClient({"--headless", "--url", "ws://127.0.0.1:1,ws://127.0.0.1:2", "--frames", "2"});
    EXPECT_EQ(nobody->exitCode(), 1) << "each was tried once";
    EXPECT_NE(nobody->err().find("cannot connect to ws://127.0.0.1:2/ws"), std::string::npos) << nobody->err();
}

// What another try will not change ends it, though it has been in.
TEST_F(ClientProgram, AServerThatStopsSendsItOnAndItComesBackWhenNobodyIsThere) {
    auto server = std::make_unique<RunningServer>(
        std::vector<std::string>{"--drain-time", "0", "--drain-to", "http://127.0.0.1:1/"});
    const std::string port = std::to_string(server->port());
    const auto client =
        startClient({"--headless", "--url", server->url(), "--size", "160x96", "--out", out_.string(), "--no-save"});
    waitForFrames(*server);
    server->process().signal(SIGTERM);
    ASSERT_TRUE(server->process().exitCode());
    const RunningServer next({"--set", "camera.position=[9,9,9]"});
    // Nobody is at the first URL: back where it was, which sends it on again.
    server = std::make_unique<RunningServer>(
        std::vector<std::string>{"--port", port, "--drain-time", "0", "--drain-to",
                                 "http://127.0.0.1:" + std::to_string(next.port()) + "/?page#top"});
    waitForFrames(*server);
    server->process().signal(SIGTERM);
    waitForFrames(next);
    client->signal(SIGINT);
    EXPECT_EQ(client->exitCode(), 0) << client->err();
    EXPECT_NE(client->err().find("the server stops; trying ws://127.0.0.1:1/ws in "), std::string::npos)
        << client->err();
    EXPECT_NE(client->err().find("; trying ws://127.0.0.1:" + std::to_string(next.port()) + "/ws in "),
              std::string::npos);
    const Json s = stats();
    EXPECT_EQ(s["connections"], 3);
    for (const Json& picture : s["pictures"])
        EXPECT_EQ(picture["pose"]["position"], Json({0, 2, 26})); // of the first server
}

TEST_F(ClientProgram, AServerThatComesBackAndWantsATokenEndsIt) {
    const fs::path key = fs::temp_directory_path() / ("brume-client-key-" + std::to_string(getpid()));
    std::ofstream(key) << std::string(32, 'k');
    fs::permissions(key, fs::perms(0600));
    auto server = std::make_unique<RunningServer>();
    const std::string port = std::to_string(server->port());
    const auto client = startClient({"--headless", "--url", server->url(), "--size", "160x96"});
    waitForFrames(*server);
    server->process().signal(SIGKILL);
    ASSERT_TRUE(server->process().exitCode());
    server = std::make_unique<RunningServer>(std::vector<std::string>{"--port", port, "--token-key", key.string()});
    EXPECT_EQ(client->exitCode(), 1) << client->err();
    const std::string err = client->err();
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 2) << err;
    EXPECT_NE(err.find("401 Unauthorized: a token is needed"), err.npos) << err;
    fs::remove(key);
}

TEST_F(ClientProgram, EveryBadStartEndsInOneLine) {
    expectOneLine(*startClient({"--headless", "--url", "ws://127.0.0.1:1"}), "cannot connect");
    expectOneLine(*startClient({"--headless", "--url", "ftp://127.0.0.1"}), "bad url");
    expectOneLine(*startClient({"--headless", "--url", url() + "/nothing"}), "HTTP 404");
    expectOneLine(*startClient({"--headless", "--url", url(), "--frames", "1", "--out", "/dev/null/frames"}),
                  "/dev/null/frames");
    expectOneLine(*startClient({"--no-such-flag"}), "--no-such-flag");
    expectOneLine(*startClient({"--size", "640"}), "--size");
    expectOneLine(*startClient({"--url", url()}, {"DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"}), "--headless");
}

// A window on SDL's dummy driver: all of the windowed program but the glass.
TEST_F(ClientProgram, AWindowShowsFramesAndReconnects) {
    const std::vector<std::string> dummy{"SDL_VIDEODRIVER=dummy"};
    const auto once = startClient({"--url", url(), "--size", "160x96", "--frames", "5", "--out", out_.string()}, dummy);
    ASSERT_EQ(once->exitCode(), 0) << once->err();
    EXPECT_EQ(stats()["frames"], 5);
    EXPECT_GT(contrast(decoded(contentOf(out_ / "frame-00005.jpg"), 160, 96)), 8);

    const auto redrawn = startClient({"--url", url(), "--size", "160x96", "--path", "orbit", "--redraw", "--seconds",
                                      "8", "--out", out_.string(), "--no-save"},
                                     dummy);
    EXPECT_EQ(redrawn->exitCode(), 0) << redrawn->err();
    EXPECT_GT(stats()["redrawn"], 10);

    auto server = std::make_unique<RunningServer>();
    const std::string port = std::to_string(server->port());
    const auto client = startClient(
        {"--url", server->url(), "--size", "160x96", "--stereo", "--out", out_.string(), "--no-save"}, dummy);
    waitForFrames(*server);
    server->process().signal(SIGKILL);
    ASSERT_TRUE(server->process().exitCode());
    server = std::make_unique<RunningServer>(std::vector<std::string>{"--port", port});
    waitForFrames(*server);
    client->signal(SIGTERM);
    EXPECT_EQ(client->exitCode(milliseconds(10'000)), 0) << client->err();
    EXPECT_EQ(stats()["connections"], 2);
}

} // namespace
} // namespace brume::test
