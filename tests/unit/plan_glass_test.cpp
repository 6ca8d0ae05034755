// What sheets of glass cost in the plan.
#include <gtest/gtest.h>

#include "server/effects/glass/glass_plan.h"
#include "tests/unit/plan_scenes.h"

namespace brume {
namespace {

Work workOf(const Scene& scene, const char* method) {
    const PlanInputs inputs = inputsOf(scene);
    RenderSettings settings = scene.render;
    settings.method = method, settings.rate = 4, settings.slabs = 32;
    return ViewWork(inputs.scene, inputs.views[0]).of(settings);
}
double ms(const Work& work) { return work.ms(builtInCosts()); }

Scene withSheets(int count) {
    Scene scene = cube();
    scene.planes.emplace_back(); // pictures pass through their targets without glass, too
    for (int i = 0; i < count; ++i) scene.glasses.push_back({.centre = {0, float(i), 0}});
    return scene;
}

// Each layer is the medium again, up to the fourth. Every sheet is looked for in each.
TEST(GlassWork, GrowsWithLayers) {
    for (const char* method : {"slabs", "grid", "isv", "tiles"}) {
        double glass = 0;
        const auto medium = [&](int sheets) { // ms without the sums
            Work work = workOf(withSheets(sheets), method);
            EXPECT_EQ(work[costs::kGlass] > glass, sheets > 0) << method << sheets;
            glass = work[costs::kGlass];
            work[costs::kGlass] = 0;
            return ms(work);
        };
        const double none = medium(0), one = medium(1), two = medium(2), four = medium(4);
        EXPECT_GT(one, none) << method;
        EXPECT_NEAR(four - two, 2 * (two - one), 1e-9 * four) << method;
        EXPECT_GT(two, one) << method;
        EXPECT_DOUBLE_EQ(medium(9), four) << method;
    }
}

TEST(GlassWork, SheetsOutOfSightAddNothing) {
    Scene scene = withSheets(3);
    for (Glass& glass : scene.glasses) glass.centre.z = 1000;
    EXPECT_DOUBLE_EQ(ms(workOf(scene, "tiles")), ms(workOf(withSheets(0), "tiles")));
    // A field's picture passes through its target.
    const Work with = workOf(scene, "slabs"), without = workOf(withSheets(0), "slabs");
    for (const CostInfo* cost : allCosts())
        EXPECT_EQ(with[*cost] - without[*cost], cost == &costs::kCompose ? 640 * 360 : 0) << cost->key;
}

// Rays of a field are made once, and surfaces are drawn once.
TEST(GlassWork, WhatIsDoneOnce) {
    const Work with = workOf(withSheets(3), "slabs"), without = workOf(withSheets(0), "slabs");
    EXPECT_DOUBLE_EQ(with[costs::kOpaque], without[costs::kOpaque]);
    int grown = 0;
    for (const CostInfo* cost : allCosts()) {
        const bool more = with[*cost] > without[*cost];
        EXPECT_TRUE(!more || std::string_view(cost->pass) == "compose" || cost == &costs::kGlass) << cost->key;
        grown += more;
    }
    EXPECT_EQ(grown, 3) << "the field's look-up, its picture, and the sums";
    EXPECT_EQ(without[costs::kGlass], 0);
    EXPECT_EQ(with[costs::kGlass], 640 * 360 * (1 + 3) * (1 + 3)) << "each pass looks for all sheets";
}

} // namespace
} // namespace brume
