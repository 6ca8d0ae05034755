// --explain: what the plan is made for, what limits it, and why every other way was left.
#include <gtest/gtest.h>

#include "server/methods/plans.h"
#include "server/plan/planner.h"

namespace brume {
namespace {

PlanInputs inputsOf() {
    Scene scene;
    scene.medium.count = 500;
    scene.medium.scale = {6, 6};
    scene.medium.extinction = 52;
    scene.lights.emplace_back();
    scene.render.method = kAutoMethod;
    PlanInputs inputs;
    inputs.scene = planScene(scene, Simulation(scene));
    inputs.views = {ownView(scene)};
    inputs.methods = allMethods();
    return inputs;
}

std::string explained(const PlanInputs& inputs) {
    return explain(makePlan(inputs, builtInCosts()), inputs, builtInCosts());
}

// The line that begins with a word.
std::string lineOf(const std::string& text, const std::string& begin) {
    const size_t at = text.find('\n' + begin);
    return at == text.npos ? "no line: " + begin : text.substr(at + 1, text.find('\n', at + 1) - at - 1);
}

TEST(Explain, NamesSizeAndCamera) {
    PlanInputs inputs = inputsOf();
    inputs.views[0] = {lookAt({1, 2, 30}, {1, 2, 0}, 0.7f), 320, 180};
    const std::string view = lineOf(explained(inputs), "view ");
    for (const char* what : {"320x180", "(1, 2, 30)", "fov_y 0.7", "outside"})
        EXPECT_NE(view.find(what), view.npos) << what << " in " << view;
    inputs.views[0].pose = lookAt({0, 0, 0}, {0, 0, -1}, 0.7f);
    EXPECT_NE(lineOf(explained(inputs), "view ").find("inside"), std::string::npos);
}

// A budget limits if a larger one would give a cheaper plan.
TEST(Explain, NamesTheBudgetThatLimits) {
    PlanInputs inputs = inputsOf();
    RenderSettings& wanted = inputs.scene.wanted;
    const auto msOf = [&](float error, float flip) {
        PlanInputs other = inputs;
        other.scene.wanted.error = error, other.scene.wanted.flip = flip;
        return makePlan(other, builtInCosts()).chosen.ms();
    };
    for (const auto& [error, flip, limit, name] :
         {std::tuple{5e-3f, 0.01f, Limit::flip, "FLIP: "}, std::tuple{5e-3f, 1.0f, Limit::error, "error: "},
          std::tuple{1.0f, 1.0f, Limit::time, "time: "}}) {
        wanted.error = error, wanted.flip = flip;
        const Plan plan = makePlan(inputs, builtInCosts());
        EXPECT_EQ(plan.limit, limit) << error << ' ' << flip;
        EXPECT_EQ(plan.chosen.ms() > msOf(error, 1), limit == Limit::flip) << error << ' ' << flip;
        EXPECT_EQ(plan.chosen.ms() > msOf(1, flip), limit == Limit::error) << error << ' ' << flip;
        const std::string line = lineOf(explain(plan, inputs, builtInCosts()), "limit ");
        EXPECT_NE(line.find(name), line.npos) << line;
    }
    wanted.error = wanted.flip = 1e-5f;
    EXPECT_NE(lineOf(explained(inputs), "limit ").find("nothing keeps both"), std::string::npos);
}

TEST(Explain, SaysWhatPropagationKeeps) {
    PlanInputs inputs = inputsOf();
    EXPECT_EQ(explained(inputs).find("of propagation"), std::string::npos);
    inputs.scene.tick.multiple.cells = 64, inputs.scene.tick.multiple.channels = 3;
    EXPECT_NE(explained(inputs).find("\nmemory      of propagation 54.4 MiB"), std::string::npos);
    inputs.scene.hues = 3;
    EXPECT_NE(explained(inputs).find("\nmemory      of propagation 163.2 MiB"), std::string::npos);
}

TEST(Explain, AMethodWithoutALawSaysSo) {
    PlanInputs inputs = inputsOf();
    for (const char* method : {"sphere", "tiles", "isv"}) {
        const std::string line = lineOf(explained(inputs), std::string("  ") + method);
        EXPECT_NE(line.find("not predicted"), line.npos) << line;
        EXPECT_EQ(line.find("3.000"), line.npos) << "a constant: " << line;
    }
    inputs.scene.wanted.method = "isv";
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_FALSE(plan.chosen.predicted);
    EXPECT_NE(summary(plan).find("not predicted"), std::string::npos) << summary(plan);
    EXPECT_NE(lineOf(explained(inputs), "limit ").find("not predicted"), std::string::npos);
}

// Every reason, not the first alone.
TEST(Explain, SaysOfEveryOtherWayWhyNot) {
    PlanInputs inputs = inputsOf();
    const Plan plan = makePlan(inputs, builtInCosts());
    const RenderSettings& wanted = inputs.scene.wanted;
    ASSERT_FALSE(plan.others.empty());
    for (const Candidate& c : plan.others) {
        const auto says = [&](const char* what) { return c.why_not.find(what) != c.why_not.npos; };
        EXPECT_EQ(says("not predicted"), !c.predicted) << c.why_not;
        EXPECT_EQ(says("error above"), c.predicted && c.error > double(wanted.error)) << c.why_not;
        EXPECT_EQ(says("FLIP above"), c.predicted && c.flip > double(wanted.flip)) << c.why_not;
        EXPECT_EQ(says("times the time"), c.ms() > plan.chosen.ms()) << c.why_not;
    }
}

// What is not predicted keeps no method from giving up accuracy of the light.
TEST(Explain, OverloadOfAMethodWithoutALawGivesUpTheLightsMap) {
    PlanInputs inputs = inputsOf();
    inputs.scene.wanted.method = "tiles";
    const Plan plan = makePlan(inputs, builtInCosts());
    inputs.relaxed = 2;
    EXPECT_GT(makePlan(inputs, builtInCosts()).chosen.settings.shadow_error, plan.chosen.settings.shadow_error);
}

TEST(Plan, AMethodThatThereIsNotIsBlamedOnWhoAskedForIt) {
    RenderSettings wanted;
    wanted.method = "magic";
    const std::vector<std::string> asked{"medium.count=5", "render.method=magic"};
    EXPECT_TRUE(
        checkWanted(wanted, "a.toml", {}).starts_with("a.toml: render.method: no method 'magic'; there are: auto, "));
    EXPECT_TRUE(checkWanted(wanted, "a.toml", asked).starts_with("--method, --set render.method: no method 'magic'"));
    EXPECT_EQ(checkWanted({.method = kAutoMethod}, "a.toml", asked), "");
}

} // namespace
} // namespace brume
