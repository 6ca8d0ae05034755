// Flags, environment and file, as brume-server reads them.
#include "server/options/options.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace brume {
namespace {

class ServerOptionsTest : public testing::Test {
protected:
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("brume-options-" + std::to_string(getpid()) + ".toml");
    void TearDown() override { std::filesystem::remove(file); }

    static ParsedOptions parsed(std::vector<const char*> arguments,
                                const std::map<std::string, std::string>& environment = {}) {
        for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
        arguments.insert(arguments.begin(), "brume-server");
        ParsedOptions result = parseServerOptions(int(arguments.size()), arguments.data());
        for (const auto& [name, value] : environment) unsetenv(name.c_str());
        return result;
    }
    static std::string settingOf(const ParsedOptions& options, const std::string& name) {
        const auto found = std::find_if(options.settings.begin(), options.settings.end(),
                                        [&](const Setting& setting) { return setting.name == name; });
        return found == options.settings.end() ? "no " + name : found->value;
    }
};

TEST_F(ServerOptionsTest, AMistakeInTheEnvironmentIsRefusedWithItsName) {
    for (const auto& [name, value, option] : std::vector<std::array<std::string, 3>>{
             {"BRUME_PORT", "70000", "--port: "},
             {"BRUME_PORT", "http", "--port: "},
             {"BRUME_MAX_VIEWERS", "0", "--max-viewers: "},
             {"BRUME_REFINE_MOVING", "2", "--refine-moving: "},
             {"BRUME_MEASURE_ERROR", "much", "--measure-error: "},
             {"BRUME_IDLE", "0", "--idle: "},
             {"BRUME_LOG_LEVEL", "loud", "--log-level: "},
             {"BRUME_PAUSED", "maybe", "--paused"},
             {"BRUME_OPEN", "maybe", "--open"},
             {"BRUME_DRAIN_TO", "https://user:secret@next.example", "--drain-to: "},
         }) {
        const ParsedOptions options = parsed({}, {{name, value}});
        EXPECT_FALSE(options.options) << name << '=' << value;
        EXPECT_EQ(options.exit_code, 2) << name << '=' << value;
        EXPECT_TRUE(options.complaint.starts_with("environment " + name + ": ")) << options.complaint;
        EXPECT_NE(options.complaint.find(option), std::string::npos) << options.complaint;
    }
}

TEST_F(ServerOptionsTest, AValueOutOfRangeIsToldTheRangeAndItsUnit) {
    for (const auto& [flag, value, line] : std::vector<std::array<const char*, 3>>{
             {"--frame-budget", "0", "--frame-budget: 0 is not allowed here; allowed: 1 to 10000 MS"},
             {"--idle", "soon", "--idle: soon is not allowed here; allowed: 1 to 3600000 MS"},
             {"--port", "70000", "--port: 70000 is not allowed here; allowed: 0 to 65535"},
             {"--token-key", "/nowhere/key", "--token-key /nowhere/key: there is no such file; make one: "},
         }) {
        const ParsedOptions options = parsed({flag, value});
        EXPECT_FALSE(options.options);
        EXPECT_TRUE(options.complaint.starts_with(line)) << options.complaint;
    }
}

TEST_F(ServerOptionsTest, APipeIsNoConfiguration) {
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
    for (const ParsedOptions& options : {parsed({"--config", file.c_str()}), parsed({}, {{"BRUME_CONFIG", file}})}) {
        EXPECT_FALSE(options.options) << "to open it would wait for its writer";
        EXPECT_NE(options.complaint.find(file.string() + ": is not a file"), std::string::npos) << options.complaint;
    }
}

TEST_F(ServerOptionsTest, AMistakeInAFlagIsNotTheEnvironments) {
    const ParsedOptions options = parsed({"--port", "70000"}, {{"BRUME_PORT", "1"}});
    EXPECT_FALSE(options.options);
    EXPECT_TRUE(options.complaint.starts_with("--port: ")) << options.complaint;
}

TEST_F(ServerOptionsTest, AFlagGoesBeforeTheEnvironmentAndThatBeforeTheFile) {
    std::ofstream(file) << "port = 1\nquality = 1\nidle = 1\nset = ['a=1']\n";
    const ParsedOptions options =
        parsed({"--config", file.c_str(), "--port", "3"},
               {{"BRUME_PORT", "2"}, {"BRUME_QUALITY", "2"}, {"BRUME_IDLE", ""}, {"BRUME_SET", "b=1\nc=2"}});
    ASSERT_TRUE(options.options) << options.complaint;
    EXPECT_EQ(options.options->net.port, 3);
    EXPECT_EQ(options.options->net.default_quality, 2);
    EXPECT_EQ(options.options->net.idle, std::chrono::milliseconds(1)) << "an empty variable is none";
    EXPECT_EQ(options.options->overrides, (std::vector<std::string>{"b=1", "c=2"}));
    EXPECT_EQ(settingOf(options, "set"), "[\"b=1\", \"c=2\"]");
}

TEST_F(ServerOptionsTest, EveryKindOfValueIsTakenFromTheEnvironment) {
    const ParsedOptions options = parsed({}, {{"BRUME_ALLOW_ORIGIN", "https://a.example,https://b.example"},
                                              {"BRUME_DRAIN_TIME", "7"},
                                              {"BRUME_REFINE_MOVING", "0.25"},
                                              {"BRUME_MEMORY", "2"},
                                              {"BRUME_METHOD", "slabs"},
                                              {"BRUME_NO_MESH_SHADERS", "true"},
                                              {"BRUME_PAUSED", "false"},
                                              {"BRUME_SCENE", "1e5"}});
    ASSERT_TRUE(options.options) << options.complaint;
    EXPECT_EQ(options.options->net.allowed_origins,
              (std::vector<std::string>{"https://a.example", "https://b.example"}));
    EXPECT_EQ(options.options->drain, std::chrono::milliseconds(7));
    EXPECT_EQ(options.options->frame.refine_moving, 0.25);
    EXPECT_EQ(options.options->frame.memory, uint64_t{2} << 20);
    EXPECT_EQ(options.options->method, "slabs");
    EXPECT_FALSE(options.options->device.mesh_shaders);
    EXPECT_EQ(options.options->paused, false);
    EXPECT_EQ(options.options->scene, "1e5");
}

TEST_F(ServerOptionsTest, AnOriginIsWhatBrowsersSend) {
    const auto taken = [](const char* origin) { return parsed({"--allow-origin", origin}).options.has_value(); };
    for (const char* good : {"*", "https://clouds.example", "http://127.0.0.1:8000", "http://[::1]:8000"})
        EXPECT_TRUE(taken(good)) << good;
    for (const char* bad : {"clouds.example", "localhost:8000", "http://localhost:8000/", "http://a.example/page",
                            "https://", "ftp://a.example", "http://a.example;b", "null"})
        EXPECT_FALSE(taken(bad)) << bad;
}

TEST_F(ServerOptionsTest, WhatNobodySaysIsTheDefault) {
    const ParsedOptions options = parsed({});
    ASSERT_TRUE(options.options) << options.complaint;
    EXPECT_EQ(options.options->paused, std::nullopt);
    EXPECT_TRUE(options.options->device.mesh_shaders);
    EXPECT_EQ(options.options->net.port, 8080);
}

// A gateway lets other machines in, whatever the server listens on.
TEST_F(ServerOptionsTest, BehindAGatewayThereIsAKeyOrOpen) {
    const ParsedOptions neither = parsed({"--proxy-protocol", "--listen", "127.0.0.1"});
    EXPECT_FALSE(neither.options);
    EXPECT_TRUE(neither.complaint.starts_with("--proxy-protocol: who comes through the gateway")) << neither.complaint;
    EXPECT_EQ(neither.complaint.find('\n'), std::string::npos);
    const ParsedOptions trusting = parsed({"--trusted-proxy", "127.0.0.1"});
    EXPECT_TRUE(trusting.complaint.starts_with("--trusted-proxy: who comes through the proxy")) << trusting.complaint;
    EXPECT_NE(parsed({"--open", "--trusted-proxy", "10.0.0.1/8"}).complaint.find("allowed: an address or a network"),
              std::string::npos);
    const ParsedOptions two = parsed({"--open", "--trusted-proxy", "127.0.0.1,10.0.0.0/8"});
    ASSERT_TRUE(two.options) << two.complaint;
    EXPECT_EQ(two.options->net.trusted_proxies.size(), 2u);
    const ParsedOptions open = parsed({"--proxy-protocol", "--open", "--agent-port", "8090"});
    ASSERT_TRUE(open.options) << open.complaint;
    EXPECT_TRUE(open.options->net.proxy_protocol);
    EXPECT_EQ(open.options->net.agent_port, 8090);
    EXPECT_FALSE(parsed({"--agent-port", "65536"}).options);
}

TEST_F(ServerOptionsTest, ANatsThatEverybodyReachesAsksWhoComes) {
    const ParsedOptions open = parsed({"--cluster", "nats://nats:4222"});
    EXPECT_FALSE(open.options);
    EXPECT_NE(open.complaint.find("nats://nats: whoever reaches it could write the cloud"), std::string::npos)
        << open.complaint;
    EXPECT_TRUE(parsed({"--cluster", "nats://brume:secret@nats:4222"}).options);
    EXPECT_FALSE(parsed({"--cluster-hosts", "https://a.example"}).options);
}

// What a reload can change: the same list as in docs/operate.md.
TEST_F(ServerOptionsTest, TheLiveOptionsAreThoseOfTheDocumentation) {
    std::ifstream in("docs/operate.md"); // tests run in the source folder
    std::vector<std::string> documented, live;
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("| `--") && line.ends_with("| yes |"))
            documented.push_back(line.substr(5, line.find('`', 5) - 5));
    for (const Setting& setting : parsed({}).settings)
        if (setting.live) live.push_back(setting.name);
    EXPECT_EQ(live, documented);
    EXPECT_GE(live.size(), 20u);
}

TEST_F(ServerOptionsTest, HelpLeadsWithWhatMostPeopleNeed) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(parsed({"--help"}).exit_code, 0);
    const std::string help = testing::internal::GetCapturedStdout();
    size_t last = 0;
    for (const char* name : {"--scene", "--set", "--method", "--listen", "--port"}) {
        const size_t at = help.find(std::string("\n  ") + name + ' ');
        ASSERT_NE(at, help.npos) << name;
        EXPECT_EQ(help.find(std::string("\n  ") + name + ' ', at + 1), help.npos) << name;
        last = std::max(last, at);
    }
    for (const char* rest : {"--config", "--scene-dir", "--max-viewers"})
        EXPECT_GT(help.find(std::string("\n  ") + rest), last) << rest;
}

} // namespace
} // namespace brume
