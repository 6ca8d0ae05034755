// What the plan knows of the settings of method isv.
#include <set>
#include <string_view>

#include <gtest/gtest.h>

#include "server/methods/plans.h"
#include "tests/unit/plan_scenes.h"

namespace brume {
namespace {

// What costs nothing does not count, and shaders are told apart.
TEST(Plan, SettingsOfIsv) {
    PlanInputs inputs = inputsOf(cube());
    RenderSettings& wanted = inputs.scene.wanted;
    wanted.method = "isv", wanted.isv = {"simpson", 3};
    const auto ms = [&] { // of the pass that draws the medium
        double sum = 0;
        for (const PassCost& pass : makePlan(inputs, builtInCosts()).passes)
            if (pass.pass == std::string_view("medium")) sum += pass.ms;
        return sum;
    };
    const double three = ms();
    wanted.isv.soft_shadows = true;
    EXPECT_EQ(ms(), three) << "nothing casts a shadow";
    inputs.scene.features.casters = true;
    EXPECT_GT(ms(), 3 * three);
    inputs.scene.features.casters = false;
    Scene lit = cube();
    lit.lights.push_back({.type = kPoint, .position = {0, 3, 0}, .intensity = glm::vec3(9)});
    inputs = inputsOf(lit);
    wanted.method = "isv", wanted.isv = {"simpson", 3};
    EXPECT_GT(ms(), 3 * three) << "a lamp is looked up at each node";
    inputs = inputsOf(cube());
    wanted.method = "isv";
    wanted.isv = {"taylor", 10};
    const double taylor = ms();
    wanted.isv.steps = 1;
    EXPECT_EQ(ms(), taylor) << "it has no steps";
    EXPECT_LT(taylor, three);
    EXPECT_EQ(makePlan(inputs, builtInCosts()).chosen.settings.isv.quadrature, "taylor");

    RenderSettings one;
    one.method = "isv";
    std::set<uint32_t> variants;
    const MethodPlan* plan = planOf("isv");
    for (const char* quadrature : {"simpson", "transmittance", "analytic", "taylor"})
        for (int bits = 0; bits < 8; ++bits) {
            one.isv = {quadrature, 3, (bits & 1) != 0, (bits & 2) != 0, bits & 4 ? 0.5f : 0};
            variants.insert(plan->variant(one));
        }
    EXPECT_EQ(variants.size(), 32u);
    for (const char* orientation : {"aligned", "random"})
        for (const char* near : {"clip", "drop"})
            for (const char* early_return : {"sum", "fixed", "none"})
                for (int bits = 0; bits < 4; ++bits) {
                    one.isv = {.quadrature = "taylor",
                               .steps = 3,
                               .orientation = orientation,
                               .near = near,
                               .early_return = early_return,
                               .taylor_step = bits & 1 ? 0.1f : kAuto,
                               .taylor_shadows = (bits & 2) != 0};
                    variants.insert(plan->variant(one));
                }
    EXPECT_EQ(variants.size(), 32u + 48 - 1) << "one of them is among the first";
    one.isv = {};
    one.isv.multiple = 0.25f;
    const uint32_t with = plan->variant(one);
    one.isv.multiple = 0.75f;
    EXPECT_EQ(plan->variant(one), with) << "a slider compiles nothing";
}

} // namespace
} // namespace brume
