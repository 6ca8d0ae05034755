// brume-load with several servers. Two plain servers of one scene have no clock in common, but they simulate the same
// from tick 1 on, until somebody pushes at one of them.
#include <csignal>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/layer.h"

namespace brume::test::load_servers_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class LoadServers : public testing::Test {
protected:
    void SetUp() override {
        out_ = fs::temp_directory_path() / ("brume-load-servers-" + std::to_string(getpid()));
        fs::remove_all(out_);
    }
    void TearDown() override { fs::remove_all(out_); }

    std::unique_ptr<Process> load(const std::string& servers, double seconds, std::vector<std::string> more) const {
        std::vector<std::string> arguments{"--server",  servers, "--width",   "160",
                                           "--height",  "96",    "--seconds", fmt::format("{}", seconds),
                                           "--warm-up", "0",     "--out",     out_.string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return startProgram(BRUME_LOAD, arguments);
    }
    Json run() const { return Json::parse(contentOf(out_ / "load.json"))["runs"][0]; }

    fs::path out_;
};

// Long enough for the younger server to come to ticks that the older one is at now.
double secondsToMeet(const RunningServer& older, const RunningServer& younger) {
    const double ahead = metric(older.port(), "brume_tick").value() - metric(younger.port(), "brume_tick").value();
    return std::max(ahead, 0.0) / 60 + 5;
}

double sentBy(const RunningServer& server) {
    return metric(server.port(), "brume_frames_total{fate=\"sent\"}").value_or(0);
}

void waitForFrames(const RunningServer& server, double frames) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (sentBy(server) < frames) {
        if (std::chrono::steady_clock::now() >= deadline) throw std::runtime_error("no frames come");
        std::this_thread::sleep_for(milliseconds(20));
    }
}

TEST_F(LoadServers, ServersThatSimulateTheSameAgree) {
    BRUME_WHOLE_LAYER_ONLY();
    const RunningServer one, two;
    const auto load = this->load(one.url() + "," + two.url(), secondsToMeet(one, two), {"--viewers", "3"});
    ASSERT_EQ(load->exitCode(), 0) << load->err();
    EXPECT_EQ(load->err(), "");
    EXPECT_NE(load->out().find(" equal (100 %)"), std::string::npos) << load->out();
    const Json run = this->run();
    EXPECT_GT(run["agreement"]["ticks_compared"], 0);
    EXPECT_EQ(run["agreement"]["ticks_equal"], run["agreement"]["ticks_compared"]);
    EXPECT_TRUE(run["agreement"]["first_difference"].is_null());
    ASSERT_EQ(run["servers"].size(), 2u);
    EXPECT_EQ(run["servers"][0]["viewers"], 2) << "in turn";
    EXPECT_EQ(run["servers"][1]["viewers"], 1);
    for (const Json& server : run["servers"]) {
        EXPECT_GT(server["frames_per_second"], 0);
        EXPECT_GT(server["tick_to_picture_ms"]["p50"], 0);
        EXPECT_LE(server["tick_to_picture_ms"]["p50"], server["tick_to_picture_ms"]["p95"]);
        EXPECT_GT(server["ticks_per_second"], 0);
        EXPECT_EQ(server["inputs_sent"], 0);
    }
}

TEST_F(LoadServers, ServersThatArePushedApartFail) {
    BRUME_WHOLE_LAYER_ONLY();
    const RunningServer one, two;
    const auto load = this->load(one.url() + "," + two.url(), secondsToMeet(one, two),
                                 {"--viewers", "2", "--push", "10", "--assert", "command_p95<=10000"});
    expectOneLine(*load, " is not the same everywhere with 2 viewers: ws://");
    const Json run = this->run();
    EXPECT_GT(run["agreement"]["ticks_compared"], run["agreement"]["ticks_equal"]);
    const Json difference = run["agreement"]["first_difference"];
    EXPECT_GT(difference["tick"], 0);
    EXPECT_NE(difference["hashes"][0], difference["hashes"][1]);
    for (const Json& server : run["servers"]) {
        EXPECT_GT(server["inputs_sent"], 0);
        EXPECT_EQ(server["inputs_refused"], 0);
        EXPECT_GT(server["command_to_tick_ms"]["p95"], 0);
    }
}

TEST_F(LoadServers, PushesThatAreRefusedAreCounted) {
    const RunningServer server({"--input-rate", "1"});
    const auto load = this->load(server.url(), 2, {"--viewers", "1", "--push", "40"});
    ASSERT_EQ(load->exitCode(), 0) << load->err();
    const Json run = this->run();
    EXPECT_FALSE(run.contains("agreement")) << "one server alone agrees with nobody";
    EXPECT_EQ(load->out().find("compared"), std::string::npos) << load->out();
    ASSERT_EQ(run["servers"].size(), 1u);
    EXPECT_GT(run["servers"][0]["inputs_refused"], 0);
    EXPECT_LE(run["servers"][0]["inputs_refused"], run["servers"][0]["inputs_sent"]);
}

TEST_F(LoadServers, ViewersOfAServerThatDiesGoOnAtTheNext) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer one;
    const RunningServer two;
    const auto load = this->load(one.url() + "," + two.url(), 8, {"--viewers", "4", "--reconnect"});
    waitForFrames(one, 40);
    waitForFrames(two, 40); // all have frames, and are counted
    one.process().signal(SIGKILL);
    ASSERT_EQ(load->exitCode(), 0) << load->err();
    const Json run = this->run();
    EXPECT_EQ(run["returns_us"].size(), 2u);
    EXPECT_EQ(run["servers"][0]["viewers"], 0);
    EXPECT_EQ(run["servers"][1]["viewers"], 4);
    EXPECT_TRUE(run["servers"][0]["cpu_s"].is_null()) << "nobody is there to tell";
    EXPECT_GT(run["away_ms"]["p50"], 0);
    EXPECT_LE(run["away_ms"]["p50"], run["away_ms"]["most"]);
    EXPECT_NE(load->out().find("- 4 viewers: 2 times one came back, after "), std::string::npos) << load->out();
}

TEST_F(LoadServers, ViewersGoWhereAGoodbyeSendsThem) {
    BRUME_WHOLE_LAYER_ONLY();
    const RunningServer other, named;
    RunningServer one({"--drain-time", "0", "--drain-to", named.url() + "/ws"});
    const auto load = this->load(one.url() + "," + other.url() + "," + named.url(), 8,
                                 {"--viewers", "4", "--reconnect"}); // one has two, the others one each
    waitForFrames(one, 40);
    waitForFrames(other, 20);
    waitForFrames(named, 20);
    one.process().signal(SIGTERM);
    ASSERT_EQ(load->exitCode(), 0) << load->err();
    const Json run = this->run();
    EXPECT_EQ(run["servers"][0]["viewers"], 0);
    EXPECT_EQ(run["servers"][1]["viewers"], 1) << "the next one of the list is not where they were sent";
    EXPECT_EQ(run["servers"][2]["viewers"], 3);
    EXPECT_EQ(run["returns_us"].size(), 2u);
}

TEST_F(LoadServers, OneThatIsNotThereEndsInOneLine) {
    const RunningServer server;
    expectOneLine(*load(server.url() + ",ws://127.0.0.1:1", 1, {"--viewers", "1"}),
                  "no server to load at ws://127.0.0.1:1");
}

} // namespace
} // namespace brume::test::load_servers_test
