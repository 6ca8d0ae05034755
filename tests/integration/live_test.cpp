// Particles of a simulation elsewhere, by messages or by files: everybody sees them.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test::live_test {
namespace {

const Pose kPose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);

// `count` rows from `first` on, of the size of a soft ball of 3 m, on the x axis from `x` on.
void setRows(Watcher& watcher, uint32_t first, uint32_t count, float x, uint32_t live, float seconds = 0) {
    std::vector<float> positions;
    for (uint32_t i = 0; i < count; ++i) positions.insert(positions.end(), {x + 0.001f * float(i), 0, 0});
    const std::vector<float> scales(count, 6.0f), extinctions(count, 0.5f);
    watcher.session.sendCommand<wire::SetParticles>([&](auto& builder) {
        return wire::CreateSetParticlesDirect(builder, first, &positions, &scales, &extinctions, nullptr, live,
                                              seconds);
    });
}

// As difference(); NaN while the sizes differ, since a slow server sends smaller pictures.
double apart(const Seen& frame, const client::Picture& to) {
    const client::Picture picture = pictureOf(frame);
    return picture.rgb.size() == to.rgb.size() ? difference(picture, to) : std::numeric_limits<double>::quiet_NaN();
}

class Live : public testing::Test {
protected:
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("brume-live-" + std::to_string(getpid()));
    const std::string scene = file.string() + ".toml";

    void SetUp() override { std::ofstream(scene) << "[medium]\nlayout = 'live'\ncount = 9000\n"; }
    void TearDown() override {
        std::filesystem::remove(scene);
        std::filesystem::remove(file);
    }
};

TEST_F(Live, WhatAnOperatorSetsEverybodySees) {
    client::Wishes jpeg = kSmall;
    jpeg.lossless = false;
    RunningServer server({"--scene", scene, "--set", "simulation.paused=true"});
    Watcher sender(server.endpoint()), viewer(server.endpoint(), jpeg);
    const std::vector<Watcher*> all{&sender, &viewer};
    sender.look(kPose); // who looks nowhere for five seconds is sent away
    viewer.look(kPose);
    ASSERT_TRUE(watch(all, [&] { return !viewer.frames.empty() && viewer.last().width == kSmall.width; }));
    const client::Picture empty = pictureOf(viewer.last());
    EXPECT_EQ(metric(server.port(), "brume_particles"), 0);

    // As many rows as a message has, twice, and the few that are left.
    setRows(sender, 0, 3000, -3, 3000);
    setRows(sender, 3000, 3000, 0, 6000);
    setRows(sender, 6000, 3000, 3, 9000);
    ASSERT_TRUE(watch(all, [&] { return apart(viewer.last(), empty) > 5; })) << "not seen";
    ASSERT_TRUE(watch(all, [&] { return metric(server.port(), "brume_particles") == 9000; }));
    EXPECT_TRUE(sender.errors.empty()) << sender.errors.front().text;

    setRows(sender, 9000, 1, 0, 9000);
    ASSERT_TRUE(watch(all, [&] { return !sender.errors.empty(); }));
    EXPECT_EQ(sender.errors[0].text, "rows 9000 ... 9001, 9000 live: the scene has medium.count = 9000 rows");
    sender.session.sendImpulse({{0, 0, 26}, {0, 0, -1}, {0, 0, 0}, 3});
    ASSERT_TRUE(watch(all, [&] { return sender.errors.size() == 2; }));
    EXPECT_EQ(sender.errors[1].code, wire::ErrorCode::unexpected);

    setRows(sender, 0, 0, 0, 0);
    ASSERT_TRUE(watch(all, [&] { return apart(viewer.last(), empty) < 0.5; })) << "still seen";
    server.process().signal(SIGTERM);
    EXPECT_EQ(server.process().exitCode(), 0);
}

TEST_F(Live, ASessionReplaysBitForBit) {
    {
        RunningServer server({"--scene", scene, "--record", file.string()});
        Watcher sender(server.endpoint());
        sender.look(kPose);
        for (int i = 0; i < 8; ++i) {
            setRows(sender, uint32_t(i), 2000, float(i), 4000, 0.25f);
            const size_t frames = sender.frames.size();
            ASSERT_TRUE(watch({&sender}, [&] { return sender.frames.size() >= frames + 2; }));
        }
        const uint64_t then = sender.last().tick;
        ASSERT_TRUE(watch({&sender}, [&] { return sender.state_tick >= then + 60; }));
        EXPECT_TRUE(sender.errors.empty()) << sender.errors.front().text;
        server.process().signal(SIGTERM);
        ASSERT_EQ(server.process().exitCode(), 0);
    }
    const auto replay = startServer({"--replay", file.string()});
    EXPECT_EQ(replay->exitCode(), 0) << replay->err();
    EXPECT_NE(replay->out().find(" with 8 commands: "), std::string::npos) << replay->out();
}

TEST_F(Live, ASequenceOfFilesIsPlayed) {
    for (const int number : {1, 2}) {
        std::ofstream ply(file.string() + "-" + std::to_string(number) + ".ply");
        ply << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
               "property float scale\nproperty float sigma_t\nend_header\n"
            << (number == 1 ? -4 : 4) << " 0 0 12 1\n";
    }
    std::ofstream(scene) << "[medium]\nlayout = 'sequence'\nfile = '" << file.filename().string()
                         << "-#.ply'\nrate = 5\n";
    RunningServer server({"--scene", scene});
    EXPECT_NE(server.process().err().find("2 files, 1 to 2, in 0.4 s, again and again; 1 points; each file is shown"),
              std::string::npos)
        << server.process().err();
    Watcher viewer(server.endpoint());
    viewer.look(kPose);
    const auto both = [&] { // pictures of each file: the two halves change places
        for (size_t i = 1; i < viewer.frames.size(); ++i)
            if (apart(viewer.frames[i], pictureOf(viewer.frames[0])) > 1) return true;
        return false;
    };
    EXPECT_TRUE(watch({&viewer}, both));
    viewer.session.sendImpulse({{0, 0, 26}, {0, 0, -1}, {0, 0, 0}, 3});
    ASSERT_TRUE(watch({&viewer}, [&] { return !viewer.errors.empty(); }));
    EXPECT_EQ(viewer.errors[0].text, "pushes move nothing here: the particles come from elsewhere");
    for (const int number : {1, 2}) std::filesystem::remove(file.string() + "-" + std::to_string(number) + ".ply");
}

TEST_F(Live, OtherScenesRefuseRowsInOneLine) {
    RunningServer server;
    Watcher sender(server.endpoint());
    setRows(sender, 0, 1, 0, 1);
    ASSERT_TRUE(watch({&sender}, [&] { return !sender.errors.empty(); }));
    EXPECT_EQ(sender.errors[0].code, wire::ErrorCode::unexpected);
}

} // namespace
} // namespace brume::test::live_test
