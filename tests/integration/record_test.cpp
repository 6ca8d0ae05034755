// A real session, recorded, killed and stepped anew: the same states, the same pictures.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include <gtest/gtest.h>

#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/net/set_message.h"

namespace brume::test {
namespace {

const Pose kPose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);

class Record : public testing::Test {
protected:
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("brume-session-" + std::to_string(getpid()));
    void TearDown() override {
        std::filesystem::remove(file);
        std::filesystem::remove(file.string() + ".old");
    }
    static std::string textOf(const std::filesystem::path& of) {
        std::ifstream in(of);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    static std::vector<std::string> framesIn(const std::string& text) {
        std::vector<std::string> found;
        const std::regex one("tick [0-9]+ frame [0-9a-f]{16}");
        for (std::sregex_iterator i(text.begin(), text.end(), one), end; i != end; ++i) found.push_back(i->str());
        return found;
    }
};

TEST_F(Record, AKilledSessionOfTwoViewersReplaysToTheSameStatesAndPictures) {
    RunningServer server({"--record", file.string(), "--frames", "45", "--set", "medium.seed=11"});
    Watcher a(server.endpoint()), b(server.endpoint());
    a.look(kPose);
    b.look(lookAt({24, 3, 0}, {0, 0, 0}, 0.8f));
    ASSERT_TRUE(watch({&a, &b}, [&] { return a.frames.size() >= 3 && b.frames.size() >= 3; }));
    for (int i = 0; i < 5; ++i) {
        a.session.sendImpulse({{0, 0, 26}, {0.01f * float(i), 0, -1}, {0, 0, 0}, 3});
        b.session.sendCommand<wire::Set>(test::set("medium.extinction", 10.1f + float(i)));
        const size_t frames = a.frames.size();
        ASSERT_TRUE(watch({&a, &b}, [&] { return a.frames.size() >= frames + 2; }));
    }
    setPaused(b, true, {&a});
    setPaused(a, false, {&b});
    const uint64_t then = a.last().tick;
    ASSERT_TRUE(
        watch({&a, &b}, [&] { return a.last().tick >= then + 130; })); // two recorded hashes and two pictures more
    EXPECT_TRUE(a.errors.empty() && b.errors.empty());
    server.process().signal(SIGKILL);
    ASSERT_EQ(server.process().exitCode(), -SIGKILL);
    const std::vector<std::string> recorded = framesIn(server.process().err());
    ASSERT_GE(recorded.size(), 3u);

    std::string first;
    for (int run = 0; run < 2; ++run) {
        const auto replay = startServer({"--replay", file.string(), "--frames", "45"});
        ASSERT_EQ(replay->exitCode(), 0) << replay->err();
        const std::string out = replay->out();
        EXPECT_NE(out.find(" with 12 commands: "), out.npos) << out;
        EXPECT_EQ(framesIn(out), recorded) << out;
        if (run > 0) {
            EXPECT_EQ(out, first);
        }
        first = out;
    }
    // Every state that a viewer was told of is one of the replay's: the last recorded tick is near the last that was
    // seen.
    std::smatch ticks;
    ASSERT_TRUE(std::regex_search(first, ticks, std::regex("replayed ([0-9]+) ticks")));
    EXPECT_GE(std::stoull(ticks[1]) + 60, a.last().tick);
}

TEST_F(Record, TheScenesOwnSettingsAreRecordedAsTheyWere) {
    const std::filesystem::path scene = file.string() + ".toml";
    std::ofstream(scene) << "[medium]\ncount = 20\n[simulation]\npaused = true\n";
    {
        RunningServer server({"--scene", scene.string(), "--record", file.string(), "--set", "render.exposure=0.1"});
        Watcher watcher(server.endpoint());
        ASSERT_TRUE(watch({&watcher}, [&] { return watcher.paused.has_value(); }));
        EXPECT_EQ(watcher.paused, true);
        ASSERT_TRUE(watch({&watcher}, [&] { return watcher.state_tick >= 60; }));
        server.process().signal(SIGTERM);
        ASSERT_EQ(server.process().exitCode(), 0);
    }
    std::ofstream(scene) << "[medium]\ncount = 21\n"; // what is recorded does not depend on the file any more
    const auto replay = startServer({"--replay", file.string()});
    EXPECT_EQ(replay->exitCode(), 0) << replay->err();
    EXPECT_NE(replay->out().find("the recording ended: stopped"), std::string::npos) << replay->out();
    std::filesystem::remove(scene);
}

TEST_F(Record, MeasuredErrorsAreRecordedUnlessNothingIsMeasured) {
    uint64_t ticks = 0; // until the first session had recorded an error
    for (const char* share : {"1", "0"}) {
        RunningServer server({"--record", file.string(), "--measure-error", share});
        Watcher watcher(server.endpoint());
        watcher.look(kPose);
        const auto done = [&] {
            if (watcher.frames.empty()) return false;
            return ticks > 0 ? watcher.last().tick >= ticks : textOf(file).find("errors") != std::string::npos;
        };
        ASSERT_TRUE(watch({&watcher}, done, milliseconds(60'000)));
        ticks = watcher.last().tick;
        server.process().signal(SIGTERM);
        ASSERT_EQ(server.process().exitCode(), 0);
        const auto replay = startServer({"--replay", file.string()});
        ASSERT_EQ(replay->exitCode(), 0) << replay->err();
        const bool told = std::regex_search(
            replay->out(), std::regex("[0-9]+ measured errors of 1 viewers; the largest: [0-9.]+ % \\([0-9.]+ to "
                                      "[0-9.]+\\) at tick [0-9]+, viewer 1 by [a-z]+, predicted [0-9.]+ %"));
        EXPECT_EQ(told, share == std::string("1")) << replay->out();
        EXPECT_EQ(textOf(file).find("errors") != std::string::npos, told);
    }
}

TEST_F(Record, ARecordingIsBoundedAndTheServerGoesOn) {
    RunningServer server(
        {"--record", file.string(), "--record-limit", "1", "--input-rate", "100000", "--message-rate", "100000"});
    Watcher watcher(server.endpoint());
    watcher.look(kPose);
    const auto is_full = [&] { return server.process().err().find("the recording is full") != std::string::npos; };
    for (float exposure = 1; !is_full(); exposure = 3 - exposure) { // 1 and 2 in turn
        for (int i = 0; i < 10; ++i)                                // some 25 KiB: a tick may take them all
            watcher.session.sendCommand<wire::Set>([&](auto& b) {
                std::vector<flatbuffers::Offset<wire::Change>> changes;
                for (int j = 0; j < 60; ++j)
                    changes.push_back(wire::CreateChangeDirect(b, "render.exposure", exposure));
                return wire::CreateSetDirect(b, &changes);
            });
        ASSERT_TRUE(watch({&watcher}, [&] { return watcher.exposure == exposure || is_full(); }));
    }
    const size_t frames = watcher.frames.size();
    EXPECT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= frames + 3; }));
    server.process().signal(SIGTERM);
    EXPECT_EQ(server.process().exitCode(), 0);
    EXPECT_TRUE(std::regex_search(server.process().err(), std::regex("recorded [0-9]+ ticks, [0-9]{3,} commands to '")))
        << server.process().err();
    EXPECT_LE(std::filesystem::file_size(file), 1u << 20);
    EXPECT_GE(std::filesystem::file_size(file), 1u << 18);
    const auto replay = startServer({"--replay", file.string()});
    EXPECT_EQ(replay->exitCode(), 0) << replay->err();
    EXPECT_NE(replay->out().find("the recording ended: full"), std::string::npos) << replay->out();
}

TEST_F(Record, WhatIsNoRecordingIsRefusedInOneLine) {
    {
        RunningServer server({"--record", file.string()});
        server.process().signal(SIGTERM);
        ASSERT_EQ(server.process().exitCode(), 0);
    }
    std::ifstream in(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const auto replayOf = [&](const std::string& content) {
        std::ofstream(file, std::ios::binary) << content;
        return startServer({"--replay", file.string()});
    };
    EXPECT_EQ(replayOf(bytes)->exitCode(), 0);
    test::expectOneLine(*replayOf(bytes.substr(0, 40)), "cut within its head");
    test::expectOneLine(*replayOf("brume-recording 16" + bytes.substr(bytes.find('\n'))),
                        "version 16; this server replays version 15");
    test::expectOneLine(*replayOf("not one\n"), "no recording");
    bytes[bytes.size() - 20] ^= 4;
    test::expectOneLine(*replayOf(bytes), "damaged");
    test::expectOneLine(*startServer({"--replay", "/nowhere"}), "/nowhere");
    test::expectOneLine(*startServer({"--record", "/nowhere/at/all", "--port", "0", "--scene", "cloud"}),
                        "/nowhere/at/all");
}

} // namespace
} // namespace brume::test
