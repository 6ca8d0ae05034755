// Frames that take too long cost accuracy, step by step; it comes back when they do not.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

// In larger pictures most of the time is that of pixels, which accuracy does not shorten.
const client::Wishes kLarge{.width = 1280, .height = 720, .views = 2, .quality = 50};
constexpr const char* kMaxPixels = "1843200";                                      // two of kLarge
constexpr const char *kError = "render.error=0.003", *kFlip = "render.flip=0.003"; // so fine that rays matter
const client::Wishes kTiny{.width = 64, .height = 36, .views = 1, .quality = 50};

double relaxed(const RunningServer& server) { return metric(server.port(), "brume_plan_relaxed").value_or(-1); }

// Watchers from places apart, so that none shares another's pictures.
std::vector<std::unique_ptr<Watcher>> watchersOf(const RunningServer& server, const client::Wishes& wishes, int count) {
    std::vector<std::unique_ptr<Watcher>> watchers;
    for (int i = 0; i < count; ++i) {
        watchers.push_back(std::make_unique<Watcher>(server.endpoint(), wishes));
        watchers.back()->look(lookAt({9.0f * float(i), 2, 26}, {0, 0, 0}, 0.8f));
    }
    return watchers;
}

// Asks ten times a second while frames come: -1 when it did not get there in a minute.
double relaxedWhen(const RunningServer& server, const std::vector<std::unique_ptr<Watcher>>& watchers,
                   const std::function<bool(double)>& there) {
    std::vector<Watcher*> all;
    for (const auto& watcher : watchers) all.push_back(watcher.get());
    double steps = -1;
    std::chrono::steady_clock::time_point next;
    const auto asked = [&] {
        if (std::chrono::steady_clock::now() < next) return false;
        next = std::chrono::steady_clock::now() + milliseconds(100);
        steps = relaxed(server);
        return there(steps);
    };
    return watch(all, asked, milliseconds(60'000)) ? steps : -1;
}

TEST(OverloadedServer, ABudgetThatCannotBeMetCostsAccuracyAndIsLogged) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer server({"--frame-budget", "1", "--max-pixels", kMaxPixels, "--set", kError, "--set", kFlip});
    EXPECT_EQ(relaxed(server), 0);
    const auto watchers = watchersOf(server, kLarge, 1);
    // The error is that of these pictures, which are larger than those that are planned for before anybody is there.
    double least = 1;
    const auto costsAccuracy = [&](double steps) {
        const double error = metric(server.port(), "brume_plan_error").value_or(0);
        if (error > 0) least = std::min(least, error);
        return steps >= 2 && error > 1.2 * least;
    };
    EXPECT_GE(relaxedWhen(server, watchers, costsAccuracy), 2);
    const std::string said = server.process().out() + server.process().err();
    EXPECT_NE(said.find("frames take too long"), said.npos) << said;
    EXPECT_NE(said.find("coarser by"), said.npos) << said;
}

// Time of a batch of pictures in ms, of so many watchers: the middle one of the first's 20 last frames of 40.
float frameTime(const client::Wishes& wishes, int count) {
    RunningServer server({"--frame-budget", "10000", "--refine-moving", "0", "--set", kError, "--set", kFlip,
                          "--max-pixels", kMaxPixels});
    const auto watchers = watchersOf(server, wishes, count);
    std::vector<Watcher*> all;
    for (const auto& watcher : watchers) all.push_back(watcher.get());
    const std::vector<Seen>& frames = all.front()->frames;
    if (!watch(
            all, [&] { return frames.size() >= 40; }, milliseconds(60'000)))
        throw std::runtime_error("40 frames did not come within a minute");
    std::vector<float> times;
    for (size_t i = frames.size() - 20; i < frames.size(); ++i) times.push_back(frames[i].render_ms);
    std::nth_element(times.begin(), times.begin() + 10, times.end());
    return times[10];
}

// Four large pictures take longer than a tiny one on every machine. The budget lies between the two; accuracy comes
// back below 4/5 of it.
TEST(OverloadedServer, AccuracyComesBackWhenTheLoadLeaves) {
    BRUME_WHOLE_LAYER_ONLY();
    const float large = frameTime(kLarge, 4), back = frameTime(kTiny, 1) / 0.8f;
    ASSERT_GT(large, 1.5 * back);
    const std::string budget = std::to_string(std::sqrt(large * back));
    RunningServer server({"--frame-budget", budget, "--refine-moving", "0", "--set", kError, "--set", kFlip,
                          "--max-pixels", kMaxPixels});
    {
        const auto heavy = watchersOf(server, kLarge, 4);
        ASSERT_GE(relaxedWhen(server, heavy, [](double steps) { return steps >= 1; }), 1);
    }
    const auto light = watchersOf(server, kTiny, 1);
    EXPECT_EQ(relaxedWhen(server, light, [](double steps) { return steps == 0; }), 0);
    const std::string said = server.process().out() + server.process().err();
    EXPECT_NE(said.find("accuracy is back"), said.npos) << said;
}

// What a server learns beside other work is not what its passes cost: started again alone it plans as if it had learnt
// nothing.
TEST(OverloadByOthers, TeachesNoCosts) {
    BRUME_WHOLE_LAYER_ONLY();
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) / ("brume-hogs-" + std::to_string(getpid()));
    const std::vector<std::string> learning{"BRUME_FIXED_COSTS"}; // removed: it learns
    {
        std::vector<std::unique_ptr<Process>> hogs;
        for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency(); ++i)
            hogs.push_back(std::make_unique<Process>(std::vector<std::string>{"/bin/sh", "-c", "while :; do :; done"}));
        RunningServer server({"--scene", "cumulus", "--ahead", "off", "--costs", (folder / "busy").string()}, learning);
        Watcher watcher(server.endpoint());
        watcher.look(lookAt({0, 8, 40}, {0, 0, 0}, 0.8f));
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        EXPECT_TRUE(
            watch({&watcher}, [&] { return !watcher.frames.empty() && std::chrono::steady_clock::now() > end; }));
        server.process().signal(SIGTERM);
        EXPECT_EQ(server.process().exitCode(), 0);
    }
    const auto plan = [&](const char* costs) {
        const auto process =
            startServer({"--scene", "cumulus", "--explain", "--costs", (folder / costs).string()}, learning);
        EXPECT_EQ(process->exitCode(), 0) << process->err();
        return process->out();
    };
    EXPECT_EQ(plan("busy"), plan("fresh"));
    std::filesystem::remove_all(folder);
}

} // namespace
} // namespace brume::test
