// Costs that are wrong are corrected by the times that passes took.
#include "server/plan/cost_learning.h"

#include <gtest/gtest.h>

#include "server/effects/particle_light/particle_light_plan.h"
#include "server/effects/shadow_volume/shadow_volume_plan.h"
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
        if (std::max(slabs[i], sphere[i]) * truth.ns[i] * 1e-6 > 1) { // ms: shorter passes say little
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
        EXPECT_LE(costs.model().ns[i], builtInCosts().ns[i] * CostLearning::kMostDear * 1.0001);
}

TEST(CostLearning, WhileOthersDisturbOnlyLowerPricesAreBelieved) {
    const PlanInputs inputs = inputsOf(cube(5000, 2));
    const Work work = workOf(inputs, "slabs");
    CostLearning costs(builtInCosts());
    for (int i = 0; i < 100; ++i) costs.learn(work, timesOf(work, builtInCosts(), 50), true);
    EXPECT_NEAR(work.ms(costs.model()), work.ms(builtInCosts()), 1e-6);
    for (int i = 0; i < 100; ++i) costs.learn(work, timesOf(work, builtInCosts(), 0.25), true);
    EXPECT_NEAR(work.ms(costs.model()) / work.ms(builtInCosts()), 0.25, 0.1);
    EXPECT_FALSE(costs.isKnown()) << "not for the next start";
}

// The bounds do not compound over starts, and what was learnt wrongly goes away.
TEST(CostLearning, WhatWasLearntWronglyIsForgotten) {
    const PlanInputs inputs = inputsOf(cube(5000, 2));
    const Work work = workOf(inputs, "slabs");
    CostModel learnt = builtInCosts();
    for (int start = 0; start < 5; ++start) {
        CostLearning costs(learnt);
        for (int i = 0; i < 500; ++i) costs.learn(work, timesOf(work, builtInCosts(), 1e9));
        learnt = costs.model();
        learnt.learnt = learnt.calibrated = true;
    }
    for (size_t i = 0; i < allCosts().size(); ++i)
        EXPECT_LE(learnt.ns[i], builtInCosts().ns[i] * CostLearning::kMostDear * 1.0001);
    EXPECT_NE(unusualCosts(learnt).find("slab_light 30 times"), std::string::npos) << unusualCosts(learnt);
    for (int start = 0; start < 2; ++start) learnt = halfForgotten(learnt);
    EXPECT_EQ(unusualCosts(learnt), "");
    for (int start = 0; start < 20; ++start) learnt = halfForgotten(learnt);
    for (size_t i = 0; i < allCosts().size(); ++i) EXPECT_NEAR(learnt.ns[i] / builtInCosts().ns[i], 1, 1e-3);
}

TEST(CostLearning, AGpuIsFasterInAllAndKeepsThat) {
    CostModel learnt = builtInCosts();
    for (double& ns : learnt.ns) ns /= 500;
    learnt.on_cpu = false;
    const CostModel half = halfForgotten(learnt);
    for (size_t i = 0; i < allCosts().size(); ++i) EXPECT_NEAR(half.ns[i] / learnt.ns[i], 1, 1e-6);
    EXPECT_EQ(unusualCosts(learnt), "");
    learnt.on_cpu = true;
    EXPECT_NE(unusualCosts(learnt), "");
}

// Each pass takes some time whatever its work.
TEST(CostLearning, APassOfLittleWorkSaysNothingOfItsPrice) {
    const PlanInputs inputs = inputsOf(cube(5, 2));
    const Work work = workOf(inputs, "slabs");
    CostLearning costs(builtInCosts());
    const double before = costs.model()[costs::kParticleLight];
    ASSERT_LT(work[costs::kParticleLight] * before * 1e-6, 0.01);
    std::vector<PassMs> passes = timesOf(work, builtInCosts(), 1);
    for (PassMs& pass : passes) pass.ms += 0.1;
    for (int i = 0; i < 100; ++i) costs.learn(work, passes);
    CostLearning few(builtInCosts());
    few.learn(work, std::vector<PassMs>{{"particle light", 0.1}});
    EXPECT_EQ(few.model().ns, builtInCosts().ns) << "nothing but a short pass ran";
    EXPECT_LT(costs.model()[costs::kParticleLight], 1.2 * before) << "it follows the mean of the others";
}

} // namespace
} // namespace brume
