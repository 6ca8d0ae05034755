// Flags, environment and file; what a reload changes; what an operator reads of it.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test {
namespace {

const Pose kPose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);

class Configuration : public testing::Test {
protected:
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("brume-config-" + std::to_string(getpid()) + ".toml");
    void TearDown() override { std::filesystem::remove(file); }

    void put(const std::string& text) const { std::ofstream(file) << text; }

    // What is printed with these, a line for each key.
    static std::string printed(std::vector<std::string> arguments, const std::vector<std::string>& environment = {}) {
        arguments.emplace_back("--print-config");
        const auto process = startProgram(BRUME_SERVER, arguments, environment);
        EXPECT_EQ(process->exitCode(), 0) << process->err();
        return process->out();
    }
    static std::string lineOf(const std::string& config, const std::string& key) {
        std::smatch found;
        return std::regex_search(config, found, std::regex("(^|\n)((# )?" + key + " =[^\n]*)")) ? found[2].str()
                                                                                                : "no " + key;
    }
    void refused(const std::string& text, const std::string& words) const {
        put(text);
        const auto process = startProgram(BRUME_SERVER, {"--config", file.string()});
        test::expectOneLine(*process, words);
    }
    // The log has these words before long.
    static bool says(Process& process, const std::string& words) {
        const auto deadline = std::chrono::steady_clock::now() + kPatience;
        while (process.err().find(words) == std::string::npos) {
            if (std::chrono::steady_clock::now() > deadline) return false;
            std::this_thread::sleep_for(milliseconds(10));
        }
        return true;
    }
};

TEST_F(Configuration, AFlagGoesBeforeTheEnvironmentAndThatBeforeTheFile) {
    put("max-viewers = 5\nport = 1234\nquality = 70\nset = ['medium.count=9', \"render.error=0.01\"]\npaused = true\n");
    const std::vector<std::string> with_file{"--config", file.string()};
    std::string config = printed(with_file);
    EXPECT_EQ(lineOf(config, "max-viewers"), "max-viewers = 5");
    EXPECT_EQ(lineOf(config, "set"), "set = [\"medium.count=9\", \"render.error=0.01\"]");
    EXPECT_EQ(lineOf(config, "paused"), "paused = true");
    EXPECT_EQ(lineOf(config, "max-streams"), "max-streams = 8");

    config =
        printed({"--config", file.string(), "--port", "1236"},
                {"BRUME_MAX_VIEWERS=6", "BRUME_PORT=1235", "BRUME_PAUSED=false",
                 "BRUME_SET=medium.count=3\nmedium.seed=4", "BRUME_ALLOW_ORIGIN=https://a.example,https://b.example"});
    EXPECT_EQ(lineOf(config, "max-viewers"), "max-viewers = 6");
    EXPECT_EQ(lineOf(config, "port"), "port = 1236");
    EXPECT_EQ(lineOf(config, "quality"), "quality = 70");
    EXPECT_EQ(lineOf(config, "paused"), "paused = false");
    EXPECT_EQ(lineOf(config, "set"), "set = [\"medium.count=3\", \"medium.seed=4\"]");
    EXPECT_EQ(lineOf(config, "allow-origin"), "allow-origin = [\"https://a.example\", \"https://b.example\"]");

    EXPECT_EQ(lineOf(printed({}, {"BRUME_CONFIG=" + file.string()}), "quality"), "quality = 70");
}

TEST_F(Configuration, WhatIsPrintedIsReadBackAsTheSame) {
    const std::string first =
        printed({"--max-viewers", "7", "--set", "light.irradiance=[1,2,3]", "--set", "name='a # \"b\"'",
                 "--allow-origin", "*", "--scene", "1e5", "--drain-to", "https://next.example/?a=b#c", "--log-file",
                 "a \"b\\c", "--refine-moving", "0.25", "--no-mesh-shaders"});
    put(first);
    EXPECT_EQ(printed({"--config", file.string()}), first);
    EXPECT_NE(first.find("max-viewers = 7"), first.npos);
}

TEST_F(Configuration, MistakesAreNamedWithFileLineKeyAndWhatIsAllowed) {
    const std::string at = file.string();
    refused("port = 1\nmax-veiwers = 3\n", at + ":2: max-veiwers: no such key; did you mean max-viewers?; allowed");
    refused("\n\nport = 70000\n", at + ":3: --port: ");
    refused("port = 'x'\n", at + ":1: ");
    refused("max-viewers = 0\n", at + ":1: --max-viewers: ");
    refused("log-level = 'loud'\n", "debug");
    refused("[server]\nport = 1\n", at + ":");
    refused("port = [1, 2]\n", at + ":1: port: allowed: one value");
    refused("paused = 'maybe'\n", at + ":1: paused: allowed: true or false");
    refused("set = [['a']]\n", at + ":1: set: allowed: an array of strings");
    refused("port = \n", at + ":1: syntax: ");
    refused("config = 'x'\n", at + ":1: config: no such key");
    refused("drain-to = 'https://user:secret@next.example'\n", "without user and password");
    test::expectOneLine(*startProgram(BRUME_SERVER, {"--config", "/nowhere.toml"}), "/nowhere.toml");
    test::expectOneLine(*startProgram(BRUME_SERVER, {}, {"BRUME_PORT=70000"}), "environment BRUME_PORT: --port: ");
}

TEST_F(Configuration, AReloadChangesWhatItCanAndNamesTheRest) {
    put("max-viewers = 1\n");
    RunningServer server({"--config", file.string()});
    Process& process = server.process();
    Watcher first(server.endpoint());
    EXPECT_THROW(Watcher(server.endpoint()), std::runtime_error);

    put("max-viewers = 2\nquality = 30\nallow-origin = ['https://a.example']\ninput-rate = 7\nscene-dir = "
        "'/elsewhere'\nport = 1\n");
    process.signal(SIGHUP);
    ASSERT_TRUE(says(process, "reload: 4 settings changed")) << process.err();
    const std::string log = process.err();
    for (const char* line : {"reload: max-viewers 1 -> 2", "reload: quality 80 -> 30", "reload: input-rate 120 -> 7",
                             "reload: allow-origin [] -> [\"https://a.example\"]", "\"/elsewhere\" needs a restart"})
        EXPECT_NE(log.find(line), log.npos) << line << " in\n" << log;
    EXPECT_EQ(log.find("reload: port"), log.npos) << "the flag goes first";
    Watcher second(server.endpoint());
    second.look(kPose);
    EXPECT_TRUE(watch({&first, &second}, [&] { return second.frames.size() >= 2; }));
    const auto upgrade = [&](const std::string& origin) {
        HttpConnection connection(server.port());
        connection.send("GET /ws HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: "
                        "websocket\r\nSec-WebSocket-Version: 13\r\n"
                        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: brume.v1\r\nOrigin: " +
                        origin + "\r\n\r\n");
        return connection.readHead().status;
    };
    EXPECT_EQ(upgrade("https://a.example"), 101);
    EXPECT_EQ(upgrade("https://b.example"), 403);

    put("max-viewers = 3\nquality = 999\n");
    process.signal(SIGHUP);
    ASSERT_TRUE(says(process, "reload: nothing is changed: " + file.string() + ":2: --quality: ")) << process.err();
    EXPECT_EQ(process.err().find("max-viewers 2 -> 3"), std::string::npos);

    put("log-level = 'error'\nmax-viewers = 2\n");
    process.signal(SIGHUP);
    ASSERT_TRUE(says(process, "reload: log-level \"info\" -> \"error\"")) << process.err();
    const size_t then = process.err().size();
    const size_t before = second.frames.size();
    EXPECT_TRUE(watch({&first, &second}, [&] { return second.frames.size() >= before + 2; }));
    process.signal(SIGTERM);
    EXPECT_EQ(process.exitCode(), 0);
    EXPECT_EQ(process.err().find("stopping", then), std::string::npos) << "is said at level info";
}

TEST_F(Configuration, ADrainIsSeenByReadyzWhileFramesFlowAndEndsWithAGoodbye) {
    RunningServer server({"--drain-time", "4000", "--drain-to", "wss://next.example/ws"});
    Watcher watcher(server.endpoint());
    watcher.look(kPose);
    ASSERT_TRUE(watch({&watcher}, [&] { return !watcher.frames.empty(); }));
    EXPECT_EQ(get(server.port(), "/readyz").status, 200);
    server.process().signal(SIGTERM);
    ASSERT_TRUE(says(server.process(), "draining"));
    const HttpReply reply = get(server.port(), "/readyz");
    EXPECT_EQ(reply.status, 503);
    EXPECT_NE(reply.body.find("drains"), std::string::npos) << reply.body;
    EXPECT_EQ(metric(server.port(), "brume_ready"), 0);
    const size_t before = watcher.frames.size();
    EXPECT_TRUE(watch(
        {&watcher}, [&] { return watcher.frames.size() >= before + 3; }, milliseconds(3500)));
    EXPECT_FALSE(watcher.goodbye);
    EXPECT_TRUE(watch({&watcher}, [&] { return watcher.goodbye.has_value(); }));
    EXPECT_EQ(watcher.go_to, "wss://next.example/ws");
    EXPECT_EQ(server.process().exitCode(), 0) << server.process().err();
}

TEST_F(Configuration, ASecondSigtermEndsAtOnce) {
    RunningServer server({"--drain-time", "60000"});
    server.process().signal(SIGTERM);
    ASSERT_TRUE(says(server.process(), "draining"));
    server.process().signal(SIGTERM);
    EXPECT_TRUE(server.process().exitCode(milliseconds(15'000))); // a quarter of the drain
}

TEST_F(Configuration, JsonLogsAreJsonToTheLastLine) {
    RunningServer server({"--log-format", "json"});
    Watcher watcher(server.endpoint());
    server.process().signal(SIGTERM);
    EXPECT_EQ(server.process().exitCode(), 0);
    std::istringstream lines(server.process().err());
    size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count) {
        const auto parsed = nlohmann::json::parse(line, nullptr, false);
        ASSERT_FALSE(parsed.is_discarded()) << line;
        EXPECT_TRUE(parsed.contains("time") && parsed.contains("level") && parsed.contains("message")) << line;
    }
    EXPECT_GE(count, 3u);
}

// The table in docs/operate.md against --print-config: every key with its default, and nothing else.
TEST_F(Configuration, TheDocumentedTableIsWhatTheServerHas) {
    for (const char* own : {"BRUME_FIXED_COSTS", "BRUME_AHEAD"}) ::unsetenv(own); // which tests run with
    std::ifstream in("docs/operate.md");                                          // tests run in the source folder
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    ASSERT_FALSE(text.empty());
    const auto help = startServer({"--help"});
    ASSERT_EQ(help->exitCode(), 0);
    const std::string config = printed({}), said = help->out();
    std::set<std::string> documented, there;
    const std::regex row("\n\\| `--([a-z-]+)` \\| ([^|]*) \\| ([^|]*) \\|");
    for (std::sregex_iterator i(text.begin(), text.end(), row), end; i != end; ++i) {
        const std::string key = (*i)[1], value = (*i)[2];
        documented.insert(key);
        EXPECT_NE(said.find("--" + key), said.npos) << key;
        const std::string line = lineOf(config, key);
        if (!value.starts_with("its ")) { // where a folder is found depends on the machine
            EXPECT_EQ(line, value.empty() ? "# " + key + " =" : key + " = " + value.substr(1, value.size() - 2));
        }
    }
    const std::regex key("\n(# )?([a-z-]+) =");
    for (std::sregex_iterator i(config.begin(), config.end(), key), end; i != end; ++i) there.insert((*i)[2]);
    EXPECT_EQ(documented, there);
    EXPECT_GE(there.size(), 40u);
    for (const std::string& one : there) {
        std::string name = "BRUME_" + one;
        std::transform(name.begin(), name.end(), name.begin(),
                       [](char c) { return c == '-' ? '_' : char(std::toupper(c)); });
        EXPECT_NE(said.find(name), said.npos) << name;
    }
}

TEST_F(Configuration, TheExampleFileIsOneThatTheServerTakes) {
    EXPECT_NE(printed({"--config", "deploy/brume.toml"}).find("listen"), std::string::npos);
}

} // namespace
} // namespace brume::test
