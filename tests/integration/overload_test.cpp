// Frames that take too long cost accuracy, step by step; it comes back when they do not.
#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test {
namespace {

constexpr client::Wishes kHuge{.width = 2560, .height = 1440, .views = 2, .quality = 50};
constexpr client::Wishes kTiny{.width = 64, .height = 36, .views = 1, .quality = 50};

Pose fromFront() { return lookAt({0, 2, 26}, {0, 0, 0}, 0.8f); }

double relaxed(const RunningServer& server) { return metric(server.port(), "brume_plan_relaxed").value_or(-1); }

// Asks while frames come: -1 when it did not get there in a minute.
double relaxedWhen(const RunningServer& server, Watcher& watcher, const std::function<bool(double)>& there) {
    double steps = -1;
    const auto asked = [&] {
        steps = relaxed(server);
        return there(steps);
    };
    return watch({&watcher}, asked, milliseconds(60'000)) ? steps : -1;
}

TEST(OverloadedServer, ABudgetThatCannotBeMetCostsAccuracyAndIsLogged) {
    RunningServer server({"--frame-budget", "1"}); // ms: far less than these pictures take
    EXPECT_EQ(relaxed(server), 0);
    const double exact = metric(server.port(), "brume_plan_error").value_or(0);
    Watcher watcher(server.endpoint(), kHuge);
    watcher.look(fromFront());
    EXPECT_GE(relaxedWhen(server, watcher, [](double steps) { return steps >= 2; }), 2);
    EXPECT_GT(metric(server.port(), "brume_plan_error").value_or(0), exact);
    const std::string said = server.process().out() + server.process().err();
    EXPECT_NE(said.find("frames take too long"), said.npos) << said;
    EXPECT_NE(said.find("coarser by"), said.npos) << said;
}

// The budget lies far between what the two pictures take on any machine: the large one has 3,200 times the pixels.
TEST(OverloadedServer, AccuracyComesBackWhenTheLoadLeaves) {
    RunningServer server({"--frame-budget", "60", "--set", "render.error=0.003"});
    {
        Watcher heavy(server.endpoint(), kHuge);
        heavy.look(fromFront());
        ASSERT_GE(relaxedWhen(server, heavy, [](double steps) { return steps >= 1; }), 1);
    }
    Watcher light(server.endpoint(), kTiny);
    light.look(fromFront());
    EXPECT_EQ(relaxedWhen(server, light, [](double steps) { return steps == 0; }), 0);
    const std::string said = server.process().out() + server.process().err();
    EXPECT_NE(said.find("frames are short enough again"), said.npos) << said;
}

} // namespace
} // namespace brume::test
