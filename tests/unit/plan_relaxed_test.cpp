// What overload gives up, and in which order.
#include <algorithm>

#include <gtest/gtest.h>

#include "server/methods/plans.h"
#include "server/methods/rays/ray_plan.h"
#include "tests/unit/plan_scenes.h"

namespace brume {
namespace {

TEST(Relaxed, SlabsThenRaysThenShadowsUntilNothingIsLeft) {
    RenderSettings s;
    s.method = "slabs", s.rate = 4, s.slabs = 32, s.shadow_error = 3e-3f, s.soft_edges = true;
    RenderSettings now = *relaxed(s, 0);
    EXPECT_TRUE(now.slabs < s.slabs && now.rate == 4 && now.shadow_error == s.shadow_error);
    now = *relaxed(now, 1);
    EXPECT_TRUE(now.slabs == 24 && now.rate == 6 && now.shadow_error == s.shadow_error);
    now = *relaxed(now, 2);
    EXPECT_TRUE(now.slabs == 24 && now.rate == 6 && now.shadow_error == 2 * s.shadow_error);
    uint32_t step = 3;
    for (; step < 100; ++step) {
        const auto next = relaxed(now, step);
        if (!next) break;
        now = *next;
    }
    EXPECT_LT(step, 100u);
    EXPECT_EQ(now.rate, 16u);
    EXPECT_EQ(now.slabs, 8u);
}

TEST(Relaxed, SharpLightGoesFirst) {
    RenderSettings s;
    s.method = "grid", s.rate = 4, s.slabs = 32, s.lamp_spacing = kFineLamps;
    RenderSettings now = *relaxed(s, 0);
    EXPECT_TRUE(now.lamp_spacing == kCoarseLamps && now.slabs == 32 && now.rate == 4);
    now = *relaxed(now, 1);
    EXPECT_TRUE(now.lamp_spacing == kCoarseLamps && now.soft_edges && now.slabs == 32 && now.rate == 4);
    now = *relaxed(now, 1);
    EXPECT_TRUE(now.lamp_spacing == kCoarseLamps && now.soft_edges && now.slabs == 32 && now.rate == 6);
    EXPECT_NE(planOf("grid")->text(now).find("6x6 pixels, 32 slabs, lamps on rays, soft edges"), std::string::npos);
    // Where that would save nothing.
    now = *relaxed(s, 0, [](const RenderSettings& way) { return way.lamp_spacing == kFineLamps && !way.soft_edges; });
    EXPECT_TRUE(now.lamp_spacing == kFineLamps && !now.soft_edges && now.slabs == 24);
}

TEST(Relaxed, OverloadPredictsLessTimeAndMoreErrorWithinTenBudgets) {
    PlanInputs inputs = inputsOf(cube(5000, 3));
    Plan last = makePlan(inputs, builtInCosts());
    for (inputs.relaxed = 1; inputs.relaxed < 20; ++inputs.relaxed) {
        const Plan plan = makePlan(inputs, builtInCosts());
        EXPECT_LE(plan.chosen.ms(), last.chosen.ms());
        EXPECT_GE(plan.chosen.error, last.chosen.error);
        EXPECT_LE(plan.chosen.error, 10 * 5e-3);
        if (plan.relaxed == inputs.relaxed) {
            EXPECT_DOUBLE_EQ(plan.less_relaxed_ms, last.chosen.ms());
        }
        last = plan;
    }
    EXPECT_LT(last.relaxed, 19u);
    EXPECT_GT(last.relaxed, 1u);
}

// In a small picture rays are so far apart that the next step would miss too much: slabs and shadows go on.
TEST(Relaxed, WhatMayNotBeGivenUpDoesNotKeepTheRest) {
    PlanInputs inputs = inputsOf(cube(5000, 3));
    inputs.scene.wanted.method = "slabs";
    inputs.views[0].width = 160, inputs.views[0].height = 90;
    const Plan plan = makePlan(inputs, builtInCosts());
    inputs.relaxed = 20;
    const Plan least = makePlan(inputs, builtInCosts());
    EXPECT_LE(least.chosen.settings.rate, 2u);
    EXPECT_LT(least.chosen.settings.slabs, plan.chosen.settings.slabs);
    EXPECT_GT(least.chosen.settings.shadow_error, 2 * plan.chosen.settings.shadow_error);
    EXPECT_LT(least.relaxed, inputs.relaxed);
    EXPECT_LE(least.chosen.error, 10 * double(inputs.scene.wanted.error));
}

} // namespace
} // namespace brume
