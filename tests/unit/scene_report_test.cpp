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
        const RenderSettings told = sceneReport(simulation, plan)->plan.settings;
        EXPECT_EQ(told.rate, method->hasRays() ? 4u : 0u) << method->name();
        EXPECT_EQ(told.slabs, method->hasRays() ? 32u : 0u) << method->name();
        EXPECT_EQ(told.quadrature, method->quadratureOf(told)) << method->name();
    }
}

} // namespace
} // namespace brume
