// brume-load itself, from its command line to its files.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "client/load/crowd.h"
#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/layer.h"

namespace brume::test::load_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Load : public testing::Test {
protected:
    void SetUp() override {
        out_ = fs::temp_directory_path() / ("brume-load-" + std::to_string(getpid()));
        fs::remove_all(out_);
    }
    void TearDown() override { fs::remove_all(out_); }

    // Small pictures, no warm-up and a folder for the results, unless the arguments say otherwise.
    std::unique_ptr<Process> load(std::vector<std::string> arguments) const {
        const std::vector<std::pair<std::string, std::string>> usual{
            {"--width", "160"}, {"--height", "96"}, {"--warm-up", "0"}, {"--out", out_.string()}};
        for (const auto& [name, value] : usual)
            if (std::find(arguments.begin(), arguments.end(), name) == arguments.end())
                arguments.insert(arguments.end(), {name, value});
        return startProgram(BRUME_LOAD, arguments);
    }
    Json result() const { return Json::parse(contentOf(out_ / "load.json")); }

    fs::path out_;
};

// Counters come over the same link as the frames: while they are asked for, far viewers would stand still and look
// late.
TEST_F(Load, ViewersGoOnWhileCountersAreAskedFor) {
    const RunningServer server;
    load::Options options;
    options.wishes.width = 160, options.wishes.height = 96;
    options.warm_up = 0;
    client::Interrupt interrupt;
    load::Crowd crowd(options, {server.endpoint()}, 1, interrupt);
    crowd.enter();
    constexpr auto frames = "brume_frames_total{fate=\"sent\"}";
    double sent = 0;
    crowd.during([&] {
        const double before = metric(server.port(), frames).value();
        for (int i = 0; i < 600 && sent < 20; ++i) { // more than a window that nobody acknowledges
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            sent = metric(server.port(), frames).value() - before;
        }
    });
    EXPECT_GE(sent, 20);
    EXPECT_THROW(crowd.during([] { throw std::runtime_error("not answered"); }), std::runtime_error);
    EXPECT_GT(crowd.watch(0.5).allFrames(), 0u);
    crowd.leave();
}

TEST_F(Load, MeasuresARunningServer) {
    BRUME_WHOLE_LAYER_ONLY();
    const RunningServer server;
    const auto load = this->load(
        {"--server", server.url(), "--viewers", "1,2", "--seconds", "3", "--warm-up", "8", // with new shaders
         "--decode", "--paths", "fly,stereo", "--assert", "fps>=1", "--assert", "p95<=10000@2"});
    ASSERT_EQ(load->exitCode(), 0) << load->err();
    EXPECT_EQ(load->err(), "");
    EXPECT_EQ(load->out(), [&] {
        std::string table;
        const client::Bytes text = contentOf(out_ / "load.md");
        const std::string all(text.begin(), text.end());
        const size_t begin = all.find("| viewers");
        return all.substr(begin, all.find("\n\n", begin) + 1 - begin);
    }());
    EXPECT_TRUE(fs::exists(out_ / "load.svg"));

    const Json j = result();
    EXPECT_EQ(j["scene"], "cloud");
    EXPECT_EQ(j["size"], Json({160, 96}));
    EXPECT_EQ(j["paths"], "fly,stereo");
    ASSERT_EQ(j["runs"].size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        SCOPED_TRACE(i);
        const Json& run = j["runs"][i];
        EXPECT_EQ(run["viewers"], i + 1);
        EXPECT_EQ(run["errors"], 0) << run["first_error"];
        const double seconds = run["seconds"], frames = run["frames"];
        EXPECT_GE(seconds, 1);
        double of_each = 0;
        for (const auto& fps : run["fps_each"]) of_each += fps.get<double>() * seconds;
        EXPECT_NEAR(of_each, frames, 0.01); // printed with four decimals
        EXPECT_GE(run["fps"]["least"], 1);
        EXPECT_LE(run["fps"]["least"], run["fps"]["median"]);
        EXPECT_LE(run["fps"]["median"], run["fps"]["most"]);
        // Poses go out 61 times a second, frames answer nearly all of them in time; a loaded machine sends fewer.
        EXPECT_GT(run["latency_ms"]["samples"], 10 * (i + 1));
        EXPECT_LE(run["latency_ms"]["samples"], 62 * (i + 1) * seconds + 60); // and those from before the run
        EXPECT_GT(run["latency_ms"]["p50"], 0);
        EXPECT_LE(run["latency_ms"]["p50"], run["latency_ms"]["p95"]);
        EXPECT_LE(run["latency_ms"]["p95"], run["latency_ms"]["p99"]);
        EXPECT_GT(run["bytes_per_second"].get<double>() * seconds, 500 * frames); // a JPEG of this size is larger
        EXPECT_GT(run["stages_ms"]["decode"], 0);
        const Json& cost = run["server"];
        // Frames that the server counted between the same two moments: those on their way at either end differ.
        EXPECT_NEAR(cost["frames_rendered"], frames, 4 * (i + 1) + 1);
        EXPECT_LE(cost["batches"], cost["frames_rendered"].get<double>() + 2);
        EXPECT_GT(cost["cpu_s"], 0);
        EXPECT_GT(cost["device_views_ms"], 0);
        EXPECT_GT(cost["device_shared_ms"], 0);
        EXPECT_GT(run["own_cpu_s"], 0);
    }
    EXPECT_EQ(metric(server.port(), "brume_viewers"), 0); // all have said goodbye
}

// Who follows gets the pictures of whom it follows.
TEST_F(Load, AClassSharesItsPictures) {
    const auto load = this->load({"--viewers", "4", "--seconds", "2", "--follow", "--paths", "orbit"});
    ASSERT_EQ(load->exitCode(), 0) << load->err();
    const Json cost = result()["runs"][0]["server"];
    EXPECT_GT(cost["pictures"], 0);
    EXPECT_GT(cost["frames_rendered"], 1.5 * cost["pictures"].get<double>());
}

TEST_F(Load, StartsAndStopsAServerAndTellsBrokenBudgets) {
    const auto load = this->load({"--viewers", "1", "--seconds", "0.5", "--assert", "fps>=100000@1", "--assert",
                                  "p50<=0", "--assert", "cpu<=1000"});
    EXPECT_EQ(load->exitCode(), 1);
    const std::string err = load->err();
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 2) << err;
    EXPECT_NE(err.find("fps>=100000@1 does not hold with 1 viewers: it is "), err.npos) << err;
    EXPECT_NE(err.find("p50<=0 does not hold"), err.npos) << err;
    EXPECT_EQ(result()["broken"].size(), 2u);
}

TEST_F(Load, AFullServerSaysHowManyGotIn) {
    expectOneLine(*load({"--viewers", "3", "--seconds", "0.5", "--start", "--scene cloud --max-viewers 2"}),
                  "2 of 3 viewers got in: the server refuses");
}

TEST_F(Load, AServerThatDiesEndsInOneLineAndKeepsWhatWasMeasured) {
    RunningServer server;
    const auto load =
        this->load({"--server", server.url(), "--viewers", "1,2", "--seconds", "0.5", "--warm-up", "0.5"});
    ASSERT_TRUE(load->lineStarting("| 1 |"));
    server.process().signal(SIGKILL);
    expectOneLine(*load, "brume-load: ");
    EXPECT_EQ(result()["runs"].size(), 1u);
}

TEST_F(Load, ViewersThatLoseTheServerComeBack) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer server;
    const auto load = this->load({"--server", server.url(), "--viewers", "2", "--seconds", "8", "--reconnect"});
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (metric(server.port(), "brume_frames_total{fate=\"sent\"}").value_or(0) < 60 &&
           std::chrono::steady_clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(20)); // both have frames, and are counted
    server.process().signal(SIGKILL);
    ASSERT_TRUE(server.process().exitCode());
    const RunningServer again({"--port", std::to_string(server.port())});
    ASSERT_EQ(load->exitCode(), 0) << load->err();
    const Json run = result()["runs"][0];
    ASSERT_EQ(run["returns_us"].size(), 2u);
    for (const Json& back : run["returns_us"]) EXPECT_LT(back[0].get<uint64_t>(), back[1].get<uint64_t>());
    EXPECT_GT(run["age_ms"]["p50"], 0);
    EXPECT_LE(run["age_ms"]["p50"], run["age_ms"]["p95"]);
    EXPECT_LE(run["age_ms"]["p95"], run["age_ms"]["most"]);
}

TEST_F(Load, ViewersWhoseConnectionIsLostAreTheSameAgain) {
    const RunningServer server({"--idle", "500"}); // ms
    const auto load = this->load({"--server", server.url(), "--viewers", "2", "--seconds", "60", "--reconnect"});
    const auto reaches = [&](const std::string& series, const auto& wanted) {
        const auto deadline = std::chrono::steady_clock::now() + kPatience;
        while (!wanted(metric(server.port(), series).value_or(-1)) && std::chrono::steady_clock::now() < deadline)
            std::this_thread::sleep_for(milliseconds(20));
        return metric(server.port(), series).value_or(-1);
    };
    const std::string sent = "brume_frames_total{fate=\"sent\"}";
    reaches(sent, [](double frames) { return frames >= 60; });
    load->signal(SIGSTOP); // a machine that sleeps
    ASSERT_EQ(reaches("brume_viewers", [](double viewers) { return viewers == 0; }), 0);
    const double before = metric(server.port(), sent).value_or(0);
    load->signal(SIGCONT);
    ASSERT_GE(reaches(sent, [&](double frames) { return frames >= before + 40; }), before + 40);
    std::set<int> ids;
    const auto viewers = Json::parse(get(server.port(), "/viewers").body)["viewers"];
    for (const Json& viewer : viewers) ids.insert(viewer["id"].get<int>());
    EXPECT_EQ(ids, (std::set<int>{1, 2}));
    load->signal(SIGINT);
    expectOneLine(*load, "interrupted");
}

TEST_F(Load, CtrlCEndsInOneLine) {
    const RunningServer server;
    const auto load = this->load({"--server", server.url(), "--viewers", "2", "--seconds", "60"});
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (metric(server.port(), "brume_viewers") != 2 && std::chrono::steady_clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(20));
    load->signal(SIGINT);
    expectOneLine(*load, "interrupted");
}

TEST_F(Load, EveryBadStartEndsInOneLine) {
    const RunningServer server;
    expectOneLine(*load({"--server", "ws://127.0.0.1:1"}), "no server to load at ws://127.0.0.1:1");
    expectOneLine(*load({"--start", "--port " + std::to_string(server.port())}), "in use");
    expectOneLine(*load({"--start", "--scene nothing"}), "no scene \"nothing\"");
    expectOneLine(*load({"--out", "/dev/null/results"}), "/dev/null/results");
    expectOneLine(*load({"--viewers", "0"}), "--viewers");
}

} // namespace
} // namespace brume::test::load_test
