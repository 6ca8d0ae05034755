// What viewers are told of the plan.
#include <gtest/gtest.h>

#include "server/loop/scene_report.h"
#include "server/methods/plans.h"

namespace brume {
namespace {

TEST(SceneReport, RaysAreToldOfMethodsThatHaveThem) {
    Scene scene;
    scene.lights.emplace_back();
    const Simulation simulation(scene);
    Plan plan;
    for (const MethodPlan* method : methodPlans()) {
        plan.chosen.settings.method = method->name();
        plan.chosen.settings.rate = 4;
        plan.chosen.settings.slabs = 32;
        const auto told = sceneReport(simulation, plan)->plan;
        EXPECT_EQ(told.rate, method->hasRays() ? 4u : 0u) << method->name();
        EXPECT_EQ(told.slabs, method->hasRays() ? 32u : 0u) << method->name();
        EXPECT_EQ(told.text, method->text(plan.chosen.settings));
    }
}

TEST(SceneReport, LiveSettingsAreToldAsCommandsSetThem) {
    Scene scene;
    scene.lights.emplace_back();
    Simulation simulation(scene);
    Plan plan;
    plan.chosen.settings.method = "slabs";
    const uint64_t before = sceneReport(simulation, plan)->settings_version;
    Command command;
    command.body = Set{{"medium.falloff", 2.5f}, {"render.method", std::string("tiles")}, {"simulation.paused", true}};
    simulation.step({&command, 1});
    const auto report = sceneReport(simulation, plan);
    EXPECT_GT(report->settings_version, before);
    ASSERT_EQ(report->settings.size(), liveSettings().size());
    std::vector<SettingValue> expected = defaultValues();
    for (size_t i = 0; i < expected.size(); ++i)
        for (const Change& change : std::get<Set>(command.body).changes)
            if (change.setting == liveSettings()[i]) expected[i] = change.value;
    EXPECT_EQ(report->settings, expected);
}

TEST(SceneReport, AnErrorIsPromisedWhereTheServerChoosesTheMethod) {
    Scene scene;
    scene.lights.emplace_back();
    scene.render.error = 0.25f;
    for (const auto& [method, promised] : {std::pair("auto", 0.25), std::pair("slabs", 0.0)}) {
        scene.render.method = method;
        Plan plan;
        plan.chosen.settings.method = "slabs";
        EXPECT_EQ(sceneReport(Simulation(scene), plan)->plan.promised, promised) << method;
    }
}

} // namespace
} // namespace brume
