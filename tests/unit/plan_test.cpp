// The plan without a device: laws that every choice must keep, whatever the constants are.
#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

#include "server/medium/band_limit.h"
#include "server/methods/plans.h"
#include "server/methods/rays/ray_plan.h"
#include "tests/unit/plan_scenes.h"

namespace brume {
namespace {

bool hasPass(const Plan& plan, std::string_view name) {
    return std::any_of(plan.passes.begin(), plan.passes.end(), [&](const PassCost& p) { return p.pass == name; });
}

// Methods that have the pass.
size_t usersOf(const CostInfo& cost) {
    size_t users = 0;
    for (const MethodPlan* plan : methodPlans())
        users += size_t(std::count(plan->costs().begin(), plan->costs().end(), &cost));
    return users;
}

TEST(Plan, ATighterBudgetNeverPredictsLessTimeOrMoreError) {
    for (const uint32_t count : {50u, 500u, 5000u}) {
        PlanInputs inputs = inputsOf(cube(count, count > 500 ? 3 : 6));
        double ms = 1e30, error = 0;
        for (const float budget : {1e-5f, 1e-3f, 2e-3f, 5e-3f, 1e-2f, 3e-2f, 0.1f, 1.0f}) {
            inputs.scene.wanted.error = budget;
            inputs.scene.wanted.flip = 1;
            const Plan plan = makePlan(inputs, builtInCosts());
            EXPECT_LE(plan.chosen.ms(), ms) << count << ' ' << budget;
            EXPECT_GE(plan.chosen.error, error) << count << ' ' << budget;
            EXPECT_EQ(plan.within, plan.chosen.error <= double(budget));
            ms = plan.chosen.ms(), error = plan.chosen.error;
        }
    }
}

// The cheapest of the ways that are as accurate as any, to a tenth.
TEST(Plan, AnUnsatisfiableBudgetTakesTheMostAccurateWayAndSaysSo) {
    PlanInputs inputs = inputsOf(cube());
    inputs.scene.wanted.error = 1e-5f; // below what any method leaves
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_FALSE(plan.within);
    double least = plan.chosen.error;
    for (const Candidate& other : plan.others) least = std::min(least, other.error);
    EXPECT_LE(plan.chosen.error, 1.1 * least);
    for (const Candidate& other : plan.others)
        EXPECT_TRUE(other.error > 1.1 * least || other.ms() >= plan.chosen.ms()) << other.ms() << ' ' << other.error;
    EXPECT_NE(explain(plan, inputs, builtInCosts()).find("NOT within the budget"), std::string::npos);
}

// Particles so small that the laws predict a picture that shows little of them, of every way: their order still counts.
TEST(Plan, WhereNoWayShowsTheMediumTheFinestIsTakenAndNotTheCheapest) {
    PlanInputs inputs = inputsOf(cube(50, 0.01f));
    inputs.scene.wanted.flip = 1;
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_FALSE(plan.within);
    EXPECT_TRUE(plan.chosen.predicted);
    EXPECT_EQ(plan.chosen.settings.rate, 1u);
    EXPECT_GE(plan.chosen.settings.slabs, 64u);
    EXPECT_GT(plan.chosen.error, 0.1);
    EXPECT_LE(plan.chosen.error, 1);
}

TEST(Plan, TheBudgetOfFlipCountsToo) {
    PlanInputs inputs = inputsOf(cube());
    inputs.scene.wanted.flip = 5e-3f; // 0.14 % of error, within what the finest maps of the light allow
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_TRUE(plan.within);
    EXPECT_LE(plan.chosen.flip, 5e-3);
}

// Whatever the constants: a device on which slabs are dear takes something else when its error is allowed.
TEST(Plan, TakesWhatIsCheapestOnTheDevice) {
    PlanInputs inputs = inputsOf(cube());
    inputs.scene.wanted.error = inputs.scene.wanted.flip = 1;
    for (const char* method : {"slabs", "grid", "sphere", "isv", "tiles"}) {
        CostModel model = builtInCosts();
        for (const MethodPlan* plan : methodPlans())
            for (const CostInfo* cost : plan->costs())
                if (usersOf(*cost) == 1)
                    model.ns[numberOf(*cost)] = std::string_view(plan->name()) == method ? 1e-6 : 1e3;
        EXPECT_EQ(makePlan(inputs, model).chosen.settings.method, method);
    }
}

TEST(Plan, WhatIsAskedForIsKept) {
    PlanInputs inputs = inputsOf(cube());
    RenderSettings& wanted = inputs.scene.wanted;
    for (const std::string& method : methodNames(inputs.scene.features)) {
        wanted.method = method;
        const Plan plan = makePlan(inputs, builtInCosts());
        EXPECT_EQ(plan.chosen.settings.method, method);
        for (const Candidate& other : plan.others) EXPECT_EQ(other.settings.method, method);
    }
    wanted.method = "slabs";
    wanted.rate = 2;
    EXPECT_EQ(makePlan(inputs, builtInCosts()).chosen.settings.rate, 2u);
    wanted.slabs = 100; // none of those that the plan would try
    EXPECT_EQ(makePlan(inputs, builtInCosts()).chosen.settings.slabs, 100u);
    wanted.method = "isv", wanted.isv = {"simpson", 7};
    EXPECT_EQ(makePlan(inputs, builtInCosts()).chosen.settings.isv.steps, 7u);
}

TEST(Plan, AUnionOfBallsIsForSpritesAndTiles) {
    PlanInputs inputs = inputsOf(cube());
    RenderSettings& wanted = inputs.scene.wanted;
    wanted.method = "sprites";
    Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_NE(plan.refused.find("sprites: it draws no medium.model = \"sum\"; use slabs or grid"), plan.refused.npos);
    EXPECT_NE(plan.chosen.settings.method, "sprites");
    inputs.scene.features.balls = true;
    EXPECT_EQ(makePlan(inputs, builtInCosts()).refused, "");
    EXPECT_EQ(makePlan(inputs, builtInCosts()).chosen.settings.method, "sprites");
    wanted.method = kAutoMethod;
    EXPECT_EQ(makePlan(inputs, builtInCosts()).chosen.settings.method, "sprites");
    wanted.method = "tiles";
    EXPECT_EQ(makePlan(inputs, builtInCosts()).chosen.settings.method, "tiles");
    wanted.tiles.light = "path";
    EXPECT_TRUE(hasPass(makePlan(inputs, builtInCosts()), "union path"));
    inputs.scene.capacity = 8193;
    EXPECT_NE(makePlan(inputs, builtInCosts()).refused.find("up to 8192 particles"), std::string::npos);
    wanted.method = "slabs";
    plan = makePlan(inputs, builtInCosts());
    EXPECT_NE(plan.refused.find("slabs: it draws no medium.model = \"union\""), plan.refused.npos);
}

// Closed by default: whatever its error may be, nobody has said what it takes.
TEST(Plan, AMediumOfTetrahedraIsForTheirMethod) {
    PlanInputs inputs = inputsOf(cube());
    inputs.scene.features.tetrahedra = true;
    RenderSettings& wanted = inputs.scene.wanted;
    EXPECT_EQ(makePlan(inputs, builtInCosts()).chosen.settings.method, "tetrahedra");
    wanted.method = "slabs";
    EXPECT_NE(makePlan(inputs, builtInCosts())
                  .refused.find("slabs: it draws no medium.model = \"tetrahedra\"; use "
                                "tetrahedra"),
              std::string::npos);
    wanted.method = "tetrahedra";
    wanted.scattering = "propagation";
    EXPECT_EQ(makePlan(inputs, builtInCosts()).refused, "");
    wanted.tetrahedra.nodes = 4;
    EXPECT_EQ(checkWanted(wanted), "tetrahedra.nodes must be 1 ... 3");
}

TEST(Plan, AMethodThatSaysNothingOfItsCostsIsNeverChosen) {
    struct Bare final : MethodPlan {
        const char* name() const override { return "bare"; }
        const char* about() const override { return "says nothing of itself"; }
        uint32_t shaders(const RenderSettings&) const override { return 0; }
    } bare;
    PlanInputs inputs = inputsOf(cube());
    inputs.scene.wanted.error = inputs.scene.wanted.flip = 1;
    inputs.methods.push_back(&bare);
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_NE(plan.chosen.settings.method, bare.name());
    for (const Candidate& other : plan.others) EXPECT_NE(other.settings.method, bare.name());
}

// The grid costs once per tick, and a viewer of it no more than its rays: many viewers of many particles share it.
TEST(Plan, ManyViewersOfManyParticlesShareTheGrid) {
    PlanInputs inputs = inputsOf(cube(5000, 3));
    inputs.views.assign(16, inputs.views.front());
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_EQ(plan.chosen.settings.method, "grid");
    EXPECT_GT(plan.chosen.settings.grid.spacing, 0);
    EXPECT_TRUE(hasPass(plan, "grid"));
    inputs.scene.wanted.method = "slabs";
    EXPECT_LT(plan.chosen.ms(), makePlan(inputs, builtInCosts()).chosen.ms());
}

// Particles of a centimetre over ten metres would want thousands of nodes a side.
TEST(Plan, AGridThatDoesNotFitIsRefusedAndSaid) {
    for (const char* wanted : {kAutoMethod, "grid"}) {
        PlanInputs inputs = inputsOf(cube(500, 0.05f));
        inputs.scene.wanted.method = wanted;
        const Plan plan = makePlan(inputs, builtInCosts());
        EXPECT_NE(plan.chosen.settings.method, "grid");
        EXPECT_NE(plan.refused.find("MiB"), plan.refused.npos);
        for (const Candidate& other : plan.others) EXPECT_NE(other.settings.method, "grid");
        EXPECT_NE(explain(plan, inputs, builtInCosts()).find("refused     grid: nodes"), std::string::npos);
    }
    EXPECT_EQ(makePlan(inputsOf(cube()), builtInCosts()).refused, "");
}

TEST(Plan, EverythingThatIsLeftOpenIsResolved) {
    const Plan plan = makePlan(inputsOf(cube()), builtInCosts());
    EXPECT_EQ(checkSettings(plan.chosen.settings), "");
    EXPECT_GT(plan.chosen.ms(), 0);
    if (planOf(plan.chosen.settings.method)->hasRays()) {
        EXPECT_GT(plan.chosen.settings.rate, 0u);
        EXPECT_GT(plan.chosen.settings.slabs, 0u);
    }
}

TEST(Plan, ASceneWithoutObjectsHasNoPassOfTheirs) {
    Scene scene = cube();
    EXPECT_FALSE(hasPass(makePlan(inputsOf(scene), builtInCosts()), "shafts"));
    scene.planes.push_back({-10, {}}); // receives, casts nothing
    EXPECT_FALSE(hasPass(makePlan(inputsOf(scene), builtInCosts()), "shafts"));
    scene.boxes.push_back({{0, 8, 0}, {4, 1, 4}, 0, {}});
    const PlanInputs inputs = inputsOf(scene);
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_TRUE(hasPass(plan, "shafts"));
    EXPECT_EQ(explain(plan, inputs, builtInCosts()).find("opaque objects"), std::string::npos);
    const PlanInputs bare = inputsOf(cube());
    EXPECT_NE(explain(makePlan(bare, builtInCosts()), bare, builtInCosts()).find("opaque objects"), std::string::npos);
}

// There and back, step by step: a way that is left is not taken again at once.
TEST(Plan, AMovingCameraDoesNotChangeTheWayEveryTick) {
    PlanInputs inputs = inputsOf(cube());
    const auto look = [&](float distance) { inputs.views[0].pose = lookAt({0, 2, distance}, {0, 0, 0}, 0.8f); };
    int changes = 0, changes_without = 0;
    RenderSettings last, last_without;
    for (int i = 0; i < 400; ++i) {
        look(20 + 30 * float(i) / 400 + (i % 2 ? 0.4f : -0.4f)); // away, trembling
        const Plan plan = makePlan(inputs, builtInCosts());
        const RenderSettings& now = plan.base;
        changes += now.rate != last.rate || now.slabs != last.slabs || now.method != last.method;
        last = now;
        const std::optional<RenderSettings> before = std::exchange(inputs.before, std::nullopt);
        const RenderSettings without = makePlan(inputs, builtInCosts()).base;
        changes_without += without.rate != last_without.rate || without.slabs != last_without.slabs;
        last_without = without;
        inputs.before = now;
    }
    EXPECT_GT(changes_without, 2 * changes) << "the walk meets no edge where it would tremble";
    EXPECT_LE(changes, 12); // of 400; 30 m are a factor of 2.5 in distance: two rates and some counts of slabs
}

TEST(Plan, FartherViewersAskForMoreRays) {
    PlanInputs inputs = inputsOf(cube(5000, 3));
    double spacing = 0;
    for (const float distance : {15.0f, 40.0f, 120.0f}) {
        inputs.views[0].pose = lookAt({0, 2, distance}, {0, 0, 0}, 0.8f);
        const double now = ViewWork(inputs.scene, inputs.views[0]).raySpacing(1);
        EXPECT_GT(now, spacing);
        spacing = now;
        const RenderSettings s = makePlan(inputs, builtInCosts()).chosen.settings;
        ASSERT_TRUE(planOf(s.method)->hasRays()) << s.method;
        EXPECT_LE(raysError(ViewWork(inputs.scene, inputs.views[0]), s.rate), 5e-3);
    }
}

// Viewers with windows of several sizes, or at several distances, cost what each would alone: rays are as far apart in
// deviations of the medium, not in pixels.
TEST(Plan, ViewersDoNotPayForOthersPixels) {
    PlanInputs inputs = inputsOf(cube(5000, 3));
    inputs.scene.wanted.method = "slabs";
    const PlanView large = inputs.views.front();
    PlanView small = large, far = large, close = large;
    small.width /= 2, small.height /= 2;
    far.pose = lookAt({0, 4, 60}, {0, 0, 0}, 0.8f);
    close.pose = lookAt({0, 1, 14}, {0, 0, 0}, 0.3f);
    for (const bool objects : {false, true})
        for (const PlanView& other : {small, far, close}) {
            inputs.scene.features.opaque = objects;
            double alone = 0;
            inputs.views = {large, other, other};
            const Plan together = makePlan(inputs, builtInCosts());
            for (const PlanView& view : {large, other, other}) {
                inputs.views = {view};
                alone += makePlan(inputs, builtInCosts()).chosen.views_ms;
            }
            EXPECT_TRUE(together.within);
            EXPECT_LT(together.chosen.views_ms, 1.25 * alone); // rates come in steps of a quarter to a half
        }
}

// For an eye deep in a dense medium nothing holds the budget. That viewer gets what is near the best for it, and the
// others get what they would have without it.
TEST(Plan, AViewInWhichNothingHoldsDoesNotMakeOthersCoarse) {
    Scene scene = cube();
    scene.medium.extinction = 700;
    PlanInputs inputs = inputsOf(scene);
    const PlanView usual = inputs.views.front();
    PlanView deep = usual;
    deep.pose = lookAt({0, 0, 0}, {0, 0, 1}, 0.8f);
    inputs.views = {deep};
    ASSERT_FALSE(makePlan(inputs, builtInCosts()).within) << "or it shows nothing";
    inputs.views = {usual, deep};
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_FALSE(plan.within);
    PlanInputs alone = inputs;
    alone.views = {usual};
    alone.scene.wanted = plan.chosen.settings;
    alone.scene.wanted.rate = rateFor(plan.chosen.settings.rate,
                                      projectedDeviation(inputs.scene.extent, usual) / plan.reference_deviation_px);
    EXPECT_LE(makePlan(alone, builtInCosts()).chosen.error, double(inputs.scene.wanted.error));
}

// FLIP that only laws say gets a margin. What the pictures show needs none.
TEST(Plan, WhatIsMeasuredMayUseTheWholeBudgetOfFlip) {
    PlanInputs inputs = inputsOf(cube());
    inputs.scene.wanted.method = "slabs";
    inputs.scene.wanted.flip = 5e-3f;
    const Plan predicted = makePlan(inputs, builtInCosts());
    Corrections corrections;
    corrections.learn(inputs.views.front().viewer, "slabs", 0.005, {1, 1, 1},
                      Corrections::Time{} + std::chrono::seconds(1));
    inputs.corrections = &corrections;
    const Plan measured = makePlan(inputs, builtInCosts());
    EXPECT_TRUE(predicted.within && measured.within);
    EXPECT_GT(measured.chosen.error, predicted.chosen.error) << summary(measured);
    EXPECT_LE(measured.chosen.error, errorOf(5e-3, false, true));
    EXPECT_LT(measured.chosen.ms(), predicted.chosen.ms());
}

// No map of the light holds the budget, by far. That is no reason to make rays and slabs coarse.
TEST(Plan, ALightThatIsAllWrongDoesNotHideCoarseRays) {
    PlanInputs inputs = inputsOf(cube(60, 1));
    for (PlanScene::Shadow& shadow : inputs.scene.shadows) shadow.resolution.error = 5;
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_FALSE(plan.within);
    const ViewWork view(inputs.scene, inputs.views.front());
    EXPECT_LT(*planOf(plan.chosen.settings.method)->error(plan.chosen.settings, view), 0.26) << summary(plan);
}

TEST(Plan, FogIsLeftToMethodsThatDrawIt) {
    Scene scene = cube();
    scene.fogs.emplace_back();
    PlanInputs inputs = inputsOf(scene);
    const CostModel model;
    EXPECT_EQ(makePlan(inputs, model).refused, "");
    for (const char* method : {"slabs", "grid"}) {
        inputs.scene.wanted.method = method;
        EXPECT_EQ(makePlan(inputs, model).chosen.settings.method, method);
    }
    inputs.scene.wanted.method = "tiles";
    const Plan plan = makePlan(inputs, model);
    EXPECT_EQ(plan.refused,
              "tiles: it draws no fog, no meshes, and no light of points and spots; use slabs, grid, froxels, lit, "
              "gradients or march");
    EXPECT_TRUE(planOf(plan.chosen.settings.method)->extras().fog);
}

// Of fog, meshes, points and spots a method may draw some.
TEST(Plan, PointsAndSpotsAreForIsvWithoutFogAndMeshes) {
    Scene scene = cube();
    scene.lights.push_back({.type = kPoint, .position = {0, 3, 0}, .intensity = glm::vec3(9)});
    PlanInputs inputs = inputsOf(scene);
    const CostModel model;
    inputs.scene.wanted.method = "isv";
    EXPECT_EQ(makePlan(inputs, model).refused, "");
    EXPECT_EQ(makePlan(inputs, model).chosen.settings.method, "isv");
    inputs.scene.wanted.method = "tiles";
    EXPECT_NE(makePlan(inputs, model).refused, "");
    inputs.scene.wanted.method = "isv";
    inputs.scene.features.meshes = true;
    const std::string refused = makePlan(inputs, model).refused;
    EXPECT_EQ(refused, "isv: it draws no fog and no meshes; use slabs, grid, froxels, lit, gradients or march");
    inputs.scene.features.meshes = false, inputs.scene.features.fog = true;
    EXPECT_EQ(makePlan(inputs, model).refused, refused);
}

TEST(Plan, AnEmptyMediumIsPlannedToo) {
    Scene scene = cube(1);
    scene.medium.extinction = 0;
    const Plan plan = makePlan(inputsOf(scene), builtInCosts());
    EXPECT_TRUE(plan.within);
    EXPECT_TRUE(std::isfinite(plan.chosen.ms()));
}

} // namespace
} // namespace brume
