// A server measures the error of its pictures while it sends them, and says it everywhere.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "client/load/scrape.h"
#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

constexpr milliseconds kLong(60'000);

const Pose kBeforeTheCloud = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);

// Frames of a viewer, up to the first that tells its error, or `most` of them.
size_t framesUntilMeasured(Watcher& watcher, size_t most, const Pose& pose = kBeforeTheCloud) {
    watcher.look(pose);
    const auto done = [&] {
        return watcher.frames.size() >= most || (!watcher.frames.empty() && watcher.last().measured > 0);
    };
    if (!watch({&watcher}, done, kLong)) throw std::runtime_error("the frames did not come");
    return watcher.frames.size();
}

TEST(MeasuredError, IsInFramesMetricsAndViewersUnlessItIsTurnedOff) {
    size_t frames = 0;
    {
        RunningServer server({"--measure-error", "1"});
        Watcher watcher(server.endpoint());
        frames = framesUntilMeasured(watcher, 10'000);
        const Seen told = watcher.last();
        EXPECT_GT(told.measured_low, 0);
        EXPECT_LT(told.measured_low, told.measured);
        EXPECT_LT(told.measured, told.measured_high);
        EXPECT_LT(told.measured_low, 0.005) << "what the scene promises";

        // Reports are made once a second: the next one knows what the frame did.
        const uint64_t tick = told.tick;
        ASSERT_TRUE(watch({&watcher}, [&] { return watcher.state_tick > tick; }));
        const load::Series metrics = load::parseSeries(get(server.port(), "/metrics").body);
        const double error = metrics.at("brume_picture_error");
        EXPECT_GT(metrics.at("brume_picture_error_low"), 0);
        EXPECT_LT(metrics.at("brume_picture_error_low"), error);
        EXPECT_LT(error, metrics.at("brume_picture_error_high"));
        EXPECT_GT(metrics.at("brume_picture_error_predicted"), 0);
        EXPECT_LT(std::abs(metrics.at("brume_picture_bias")), 0.05);
        const auto viewers = nlohmann::json::parse(get(server.port(), "/viewers").body)["viewers"];
        ASSERT_EQ(viewers.size(), 1u);
        ASSERT_EQ(viewers[0]["error"].size(), 1u) << viewers;
        const nlohmann::json& said = viewers[0]["error"].front();
        EXPECT_LT(said["low"], said["relative_rmse"]);
        EXPECT_LT(said["relative_rmse"], said["high"]);
        EXPECT_GE(said["pixels"], 100);
    }
    RunningServer server({"--measure-error", "0"});
    Watcher watcher(server.endpoint());
    EXPECT_EQ(framesUntilMeasured(watcher, 2 * frames), 2 * frames);
    EXPECT_FALSE(metric(server.port(), "brume_picture_error"));
}

TEST(MeasuredError, FogWithoutParticlesIsMeasured) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer server({"--measure-error", "1", "--scene", "dusty-room"});
    Watcher watcher(server.endpoint());
    framesUntilMeasured(watcher, 10'000, lookAt({-2.4f, 1.5f, 3.6f}, {0.9f, 1.15f, -1.2f}, 1));
    EXPECT_GT(watcher.last().measured, 0);
    EXPECT_LT(watcher.last().measured_low, 0.005) << "what the scene promises";
}

TEST(MeasuredError, ABrokenPromiseIsLogged) {
    // A map of the light that is too coarse for render.error, which is 0.5 %, whatever the plan takes.
    RunningServer server({"--measure-error", "1", "--set", "render.shadow_size=16", "--set", "render.shadow_slices=7"});
    Watcher watcher(server.endpoint());
    framesUntilMeasured(watcher, 10'000);
    const auto said = [&] { return server.process().out() + server.process().err(); };
    EXPECT_TRUE(watch(
        {&watcher},
        [&] { return said().find("pictures err more than render.error promises (0.5 %)") != std::string::npos; },
        kLong))
        << said();
}

} // namespace
} // namespace brume::test
