// The plan of a running scene: when it is made anew. Times are passed in.
#include <gtest/gtest.h>

#include "tests/layer.h"
#include "tests/unit/plan_scenes.h"

namespace brume::planner_test {
namespace {

using std::chrono::milliseconds;

const Planner::Time kStart = Planner::Time{} + std::chrono::hours(1);

bool samePlan(const RenderSettings& a, const RenderSettings& b) {
    const MethodSettings &own_of_a = a, &own_of_b = b;
    return a.method == b.method && a.rate == b.rate && a.slabs == b.slabs && a.shadow_error == b.shadow_error &&
           own_of_a == own_of_b;
}

// How often the settings change in twelve seconds of sixty frames, of `ms` each. Every frame has the own view and those
// that `add` gives.
template <typename Add>
int changesOf(const Scene& scene, double budget_ms, double ms, const Add& add) {
    const Simulation simulation(scene);
    Planner planner(scene, builtInCosts(), budget_ms);
    RenderSettings last;
    int changes = 0;
    for (int frame = 0; frame < 720; ++frame) {
        const Planner::Time now = kStart + milliseconds(frame * 1000 / 60);
        std::vector<PlanView> views{ownView(scene)};
        add(frame, views);
        RenderSettings settings = planner.settings(simulation, views, false, now);
        if (const uint32_t own = planner.rateOf(views.front(), settings); own > 0) settings.rate = own;
        planner.refresh(simulation, views, now);
        planner.took(ms, now + milliseconds(10));
        changes += frame > 0 && !samePlan(settings, last);
        last = settings;
    }
    return changes;
}

// Each of four has another size in each frame, and not all are there in each.
void addChangers(int frame, std::vector<PlanView>& views) {
    constexpr uint32_t kSizes[][2] = {{320, 180}, {480, 270}, {640, 360}, {960, 540}, {540, 960}};
    for (uint32_t viewer = 0; viewer < 4; ++viewer) {
        const uint32_t draw = (uint32_t(frame) * 2654435761u + viewer * 40503u) >> 8;
        if (draw % 3 == 0) continue;
        PlanView view = views.front();
        view.pose.position += glm::vec3(float(viewer) * 3 - 5, 1, 0);
        view.width = kSizes[draw % 5][0], view.height = kSizes[draw % 5][1];
        views.push_back(view);
    }
}

TEST(Planner, ViewersWhoChangeSizeDoNotMoveThePlan) {
    BRUME_WHOLE_LAYER_ONLY();
    for (const auto& [count, scale] : {std::pair(500u, 6.0f), std::pair(5000u, 2.0f), std::pair(2000u, 1.0f)}) {
        const Scene scene = cube(count, scale);
        EXPECT_LE(changesOf(scene, 1000, 20, addChangers), 2) << count << " of " << scale;
    }
}

TEST(Planner, WhatItDoesNotChooseIsAsAskedFor) {
    const Scene scene = cube();
    Simulation simulation(scene);
    Planner planner(scene, builtInCosts(), 50);
    const PlanView view = ownView(scene);
    const float before = planner.settings(simulation, {&view, 1}, true, kStart).exposure;
    const Command command{1, 1, Set{{"render.exposure", 2 * before}}};
    simulation.step({&command, 1});
    EXPECT_EQ(planner.settings(simulation, {&view, 1}, true, kStart + milliseconds(20)).exposure, 2 * before);
}

// A grid of the medium is dear where particles move, since it is filled each tick. Where they rest it is there already.
TEST(Planner, WhatIsDoneOncePerTickCostsLittleWhereTheMediumRests) {
    Scene scene = cube(20000, 1.5f);
    scene.simulation.impulse_radius = 10;
    scene.simulation.impulse_strength = 5;
    Simulation simulation(scene);
    Planner planner(scene, builtInCosts(), 1000);
    const PlanView view = ownView(scene);
    const auto tick = [&](int ms, std::span<const Command> commands) -> const Candidate& {
        simulation.step(commands);
        planner.settings(simulation, {&view, 1}, !commands.empty(), kStart + milliseconds(ms));
        planner.refresh(simulation, {&view, 1}, kStart + milliseconds(ms));
        return planner.plan().chosen;
    };
    const Candidate moving = tick(0, {});
    EXPECT_EQ(moving.settings.method, "slabs");
    Candidate resting;
    for (int ms = 100; ms <= 5000; ms += 100) resting = tick(ms, {});
    EXPECT_EQ(resting.settings.method, "grid");
    EXPECT_LT(resting.ms(), 0.8 * moving.ms());
    const Command push{1, 1, Impulse{.origin = {0, 0, 20}}};
    EXPECT_EQ(tick(5100, {&push, 1}).settings.method, "slabs");
}

TEST(Planner, UnderOverloadItGivesUpAccuracyStepByStepWhateverSizesThereAre) {
    const int steps = changesOf(cube(5000, 2), 10, 20, [](int, std::vector<PlanView>&) {});
    EXPECT_GT(steps, 2);
    EXPECT_LE(changesOf(cube(5000, 2), 10, 20, addChangers), steps + 2);
}

} // namespace
} // namespace brume::planner_test
