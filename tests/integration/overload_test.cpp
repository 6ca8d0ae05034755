// Frames that take too long cost accuracy, step by step; it comes back when they do not.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test {
namespace {

// In larger pictures most of the time is that of pixels, which accuracy does not shorten.
constexpr client::Wishes kLarge{.width = 1280, .height = 720, .views = 2, .quality = 50};
constexpr const char* kMaxPixels = "1843200";                                      // two of kLarge
constexpr const char *kError = "render.error=0.003", *kFlip = "render.flip=0.003"; // so fine that rays matter
constexpr client::Wishes kTiny{.width = 64, .height = 36, .views = 1, .quality = 50};

Pose fromFront() { return lookAt({0, 2, 26}, {0, 0, 0}, 0.8f); }

double relaxed(const RunningServer& server) { return metric(server.port(), "brume_plan_relaxed").value_or(-1); }

// Asks ten times a second while frames come: -1 when it did not get there in a minute.
double relaxedWhen(const RunningServer& server, Watcher& watcher, const std::function<bool(double)>& there) {
    double steps = -1;
    std::chrono::steady_clock::time_point next;
    const auto asked = [&] {
        if (std::chrono::steady_clock::now() < next) return false;
        next = std::chrono::steady_clock::now() + milliseconds(100);
        steps = relaxed(server);
        return there(steps);
    };
    return watch({&watcher}, asked, milliseconds(60'000)) ? steps : -1;
}

TEST(OverloadedServer, ABudgetThatCannotBeMetCostsAccuracyAndIsLogged) {
    RunningServer server({"--frame-budget", "1", "--max-pixels", kMaxPixels, "--set", kError, "--set", kFlip});
    EXPECT_EQ(relaxed(server), 0);
    Watcher watcher(server.endpoint(), kLarge);
    watcher.look(fromFront());
    // The error is that of these pictures, which are larger than those that are planned for before anybody is there.
    double least = 1;
    const auto costsAccuracy = [&](double steps) {
        const double error = metric(server.port(), "brume_plan_error").value_or(0);
        if (error > 0) least = std::min(least, error);
        return steps >= 2 && error > 1.2 * least;
    };
    EXPECT_GE(relaxedWhen(server, watcher, costsAccuracy), 2);
    const std::string said = server.process().out() + server.process().err();
    EXPECT_NE(said.find("frames take too long"), said.npos) << said;
    EXPECT_NE(said.find("coarser by"), said.npos) << said;
}

// What the middle one of 20 frames took, in ms.
float frameTime(const client::Wishes& wishes) {
    RunningServer server({"--frame-budget", "10000", "--refine-moving", "0", "--set", kError, "--set", kFlip,
                          "--max-pixels", kMaxPixels});
    Watcher watcher(server.endpoint(), wishes);
    watcher.look(fromFront());
    if (!watch(
            {&watcher}, [&] { return watcher.frames.size() >= 20; }, milliseconds(60'000)))
        throw std::runtime_error("20 frames did not come within a minute");
    std::vector<float> times;
    for (const Seen& frame : watcher.frames) times.push_back(frame.render_ms);
    std::nth_element(times.begin(), times.begin() + 10, times.end());
    return times[10];
}

// The budget lies between what the two pictures take on this machine; the large one has 800 times the pixels.
TEST(OverloadedServer, AccuracyComesBackWhenTheLoadLeaves) {
    const float large = frameTime(kLarge), small = frameTime(kTiny);
    ASSERT_GT(large, 3 * small); // accuracy comes back below 4/5 of the budget
    const std::string budget = std::to_string(std::sqrt(large * small));
    RunningServer server({"--frame-budget", budget, "--refine-moving", "0", "--set", kError, "--set", kFlip,
                          "--max-pixels", kMaxPixels});
    {
        Watcher heavy(server.endpoint(), kLarge);
        heavy.look(fromFront());
        ASSERT_GE(relaxedWhen(server, heavy, [](double steps) { return steps >= 1; }), 1);
    }
    Watcher light(server.endpoint(), kTiny);
    light.look(fromFront());
    EXPECT_EQ(relaxedWhen(server, light, [](double steps) { return steps == 0; }), 0);
    const std::string said = server.process().out() + server.process().err();
    EXPECT_NE(said.find("accuracy is back"), said.npos) << said;
}

} // namespace
} // namespace brume::test
