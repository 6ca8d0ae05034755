// Costs that are wrong are corrected by the times that passes took.
#include "server/plan/cost_learning.h"

#include <gtest/gtest.h>

#include "server/plan/plan.h"
#include "tests/unit/plan_scenes.h"

namespace brume {
namespace {

// The times that a machine takes which is `slower` than `truth` says.
std::vector<PassMs> timesOf(const Work& work, const CostModel& truth, double slower) {
    std::vector<PassMs> passes;
    for (const CostInfo* cost : allCosts())
        if (work[*cost] > 0) { // "cull, sort": all of it as the first
            const std::string_view all = cost->pass;
            passes.push_back({all.substr(0, all.find(", ")), slower * work[*cost] * truth[*cost] * 1e-6});
        }
    return passes;
}

Work workOf(const PlanInputs& inputs, const char* method) {
    RenderSettings settings = inputs.scene.wanted;
    settings.method = method, settings.rate = 4, settings.slabs = 64;
    Work work = sharedWork(inputs.scene, settings);
    work += shadowWork(inputs.scene, inputs.scene.shadows.front());
    work += ViewWork(inputs.scene, inputs.views[0]).of(settings);
    return work;
}

TEST(CostLearning, ASlowMachineIsKnownAfterSomePictures) {
    const PlanInputs inputs = inputsOf(cube(5000, 2));
    const Work slabs = workOf(inputs, "slabs"), sphere = workOf(inputs, "sphere");
    CostLearning costs(builtInCosts());
    EXPECT_FALSE(costs.isKnown());
    for (int i = 0; i < 30; ++i) costs.learn(slabs, timesOf(slabs, builtInCosts(), 10));
    EXPECT_TRUE(costs.isKnown());
    EXPECT_NEAR(slabs.ms(costs.model()) / slabs.ms(builtInCosts()), 10, 0.5);
    EXPECT_NEAR(sphere.ms(costs.model()) / sphere.ms(builtInCosts()), 10, 1) << "a pass that did not run yet";
    EXPECT_EQ(costs.first().ns, builtInCosts().ns);
}

// Each method's own passes are wrong by another factor, and what both share is right.
TEST(CostLearning, AMethodThatIsWrongIsCorrectedWithoutHarmToOthers) {
    const PlanInputs inputs = inputsOf(cube(5000, 2));
    const Work slabs = workOf(inputs, "slabs"), sphere = workOf(inputs, "sphere");
    CostModel truth = builtInCosts();
    for (size_t i = 0; i < allCosts().size(); ++i)
        if ((slabs[i] > 0) != (sphere[i] > 0)) truth.ns[i] *= slabs[i] > 0 ? 4 : 0.25;
    CostLearning costs(builtInCosts());
    for (int i = 0; i < 200; ++i) {
        costs.learn(slabs, timesOf(slabs, truth, 1));
        costs.learn(sphere, timesOf(sphere, truth, 1));
    }
    for (size_t i = 0; i < allCosts().size(); ++i)
        if (slabs[i] > 0 || sphere[i] > 0) {
            EXPECT_NEAR(costs.model().ns[i] / truth.ns[i], 1, 0.05) << allCosts()[i]->key;
        }
}

TEST(CostLearning, IsBoundedAndIgnoresWhatDidNotRun) {
    const PlanInputs inputs = inputsOf(cube(5000, 2));
    const Work work = workOf(inputs, "slabs");
    CostLearning costs(builtInCosts());
    costs.learn(work, {});
    EXPECT_EQ(costs.model().ns, builtInCosts().ns);
    for (int i = 0; i < 500; ++i) costs.learn(work, timesOf(work, builtInCosts(), 1e9));
    for (size_t i = 0; i < allCosts().size(); ++i)
        EXPECT_LE(costs.model().ns[i], builtInCosts().ns[i] * CostLearning::kMost * 1.0001);
}

} // namespace
} // namespace brume
