// What is not compiled is not planned as long as something else is, and is wanted; a plan is made anew for an eye that
// is suddenly far from where it was.
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "server/compile/compiled_ways.h"
#include "server/loop/scene_report.h"
#include "tests/unit/plan_scenes.h"

namespace brume::compiled_ways_test {
namespace {

using std::chrono::seconds;

PlanView viewFrom(glm::vec3 position) { return {lookAt(position, {0.5f, 0, 0}, 0.8f), 640, 360}; }
const PlanView kOutside = viewFrom({0, 2, 26}), kInside = viewFrom({0, 1, 2});

// As a server has them that has compiled nothing yet.
struct NothingCompiled : CompiledWays {
    NothingCompiled() { setAll(false); }
};

TEST(CompiledWays, AWayIsReadAsItWasWritten) {
    for (const WayShaders& way : {WayShaders{"slabs", 0, 12, false}, WayShaders{"isv", 514, 0, true}}) {
        ASSERT_TRUE(wayShaders(text(way)));
        EXPECT_EQ(wayShaders(text(way)), way);
    }
    for (const char* line :
         {"", "slabs", "slabs 0 12", "slabs 0 12 resting", "slabs x 12 still", "none 0 12 still", "slabs 0 12 still 1"})
        EXPECT_FALSE(wayShaders(line)) << line;
}

TEST(CompiledWays, WaysThatHaveOtherShadersDiffer) {
    RenderSettings one;
    one.method = "grid", one.rate = 4, one.slabs = 32, one.grid.spacing = 0.5f;
    RenderSettings other = one;
    other.slabs = 64, other.shadow_error = 1e-3f, other.grid.spacing = 0.7f;
    EXPECT_EQ(shadersOf(one, false), shadersOf(other, false)) << "the same shaders";
    EXPECT_NE(shadersOf(one, false), shadersOf(one, true));
    other.grid.spacing = 0.2f;
    EXPECT_NE(shadersOf(one, false), shadersOf(other, false)) << "samples are cubic";
    other = one, other.rate = 6;
    EXPECT_NE(shadersOf(one, false), shadersOf(other, false));
    other = one, other.method = "slabs";
    EXPECT_NE(shadersOf(one, false), shadersOf(other, false));
}

// Pictures keep the features of their lists until something is compiled with the others.
TEST(CompiledWays, OtherListsAreFollowedOnceSomethingIsCompiledForThem) {
    const SceneFeatures none, fog{.fog = true};
    RenderSettings settings;
    settings.method = "slabs", settings.rate = 4;
    const WayShaders way = shadersOf(settings, false);
    NothingCompiled ways;
    int asked = 0;
    ways.serve([&] { ++asked; });
    ways.add(way);
    EXPECT_TRUE(ways.follow(none));
    EXPECT_FALSE(ways.follow(fog));
    EXPECT_FALSE(ways.follow(fog));
    EXPECT_EQ(asked, 1) << "once";
    EXPECT_EQ(ways.wantedFeatures(), fog);
    EXPECT_TRUE(ways.has(settings, false)) << "of those that are drawn";
    ways.add(fog, way);
    EXPECT_FALSE(ways.wantedFeatures());
    EXPECT_TRUE(ways.follow(fog));
    EXPECT_EQ(ways.features(), fog);
    EXPECT_TRUE(ways.has(settings, false));
    settings.rate = 8;
    EXPECT_FALSE(ways.has(settings, false));
    EXPECT_TRUE(ways.follow(none)) << "it has been compiled before";
    EXPECT_TRUE(CompiledWays().follow(fog)) << "nothing is compiled behind";
}

// Who compiles takes a second. What it has made is of the lists that were drawn when the way was wanted.
TEST(CompiledWays, AWayIsCompiledForTheListsThatItWasWantedFor) {
    const SceneFeatures none, lobe{.lobe = true};
    RenderSettings settings;
    settings.method = "slabs", settings.rate = 1;
    NothingCompiled ways;
    ways.want(settings, true);
    const auto wanted = ways.nextWanted();
    ASSERT_TRUE(wanted);
    settings.rate = 4;
    ways.add(lobe, shadersOf(settings, false));
    ASSERT_TRUE(ways.follow(lobe));
    ways.add(wanted->lists, wanted->shaders);
    EXPECT_FALSE(ways.has(wanted->settings, true));
    ways.add(none, shadersOf(settings, false));
    ASSERT_TRUE(ways.follow(none));
    EXPECT_TRUE(ways.has(wanted->settings, true));
}

TEST(CompiledWays, PixelsAreReadBackWhereThatIsCompiledToo) {
    NothingCompiled ways;
    RenderSettings way;
    way.method = "slabs", way.rate = 12;
    EXPECT_FALSE(ways.mayProbe(way));
    ways.add(shadersOf(way, false), false);
    EXPECT_TRUE(ways.has(way, false));
    EXPECT_FALSE(ways.mayProbe(way));
    ways.add(shadersOf(way, false), true);
    EXPECT_TRUE(ways.mayProbe(way));
    ways.add(shadersOf(way, false), false);
    EXPECT_TRUE(ways.mayProbe(way)) << "what is compiled stays so";
    EXPECT_TRUE(CompiledWays().mayProbe(way)) << "nothing is compiled behind";
}

TEST(CompiledWays, WhatIsWantedIsToldOnceAndNoMoreWhenItIsCompiled) {
    NothingCompiled ways;
    int told = 0;
    ways.serve([&] { ++told; });
    RenderSettings way;
    way.method = "slabs", way.rate = 12;
    ways.want(way, false);
    ways.want(way, false);
    EXPECT_EQ(told, 1);
    ASSERT_TRUE(ways.nextWanted());
    EXPECT_EQ(ways.nextWanted()->shaders, shadersOf(way, false));
    EXPECT_FALSE(ways.has(way, false));
    const uint64_t before = ways.version();
    ways.add(shadersOf(way, false));
    EXPECT_GT(ways.version(), before);
    EXPECT_TRUE(ways.has(way, false));
    EXPECT_FALSE(ways.has(way, true));
    EXPECT_FALSE(ways.nextWanted());
    ways.want(way, false);
    EXPECT_EQ(told, 1);
    for (way.rate = 1; way.rate <= 100; ++way.rate) ways.want(way, true);
    EXPECT_LT(told, 20) << "their number is bounded";
    ways.setAll(true);
    EXPECT_TRUE(ways.has(way, true));
}

TEST(CompiledWays, APlanTakesTheBestCompiledWayAndNamesWhatItWouldHaveTaken) {
    PlanInputs inputs = inputsOf(cube());
    inputs.views = {kInside};
    const Plan free = makePlan(inputs, builtInCosts());
    EXPECT_TRUE(free.missing.empty());
    const WayShaders best = shadersOf(free.chosen.settings, false);
    for (const std::string method : {"slabs", "grid", "tiles"}) {
        inputs.compiled = [&](const RenderSettings& way) {
            return way.method == method && shadersOf(way, false) != best;
        };
        const Plan plan = makePlan(inputs, builtInCosts());
        EXPECT_TRUE(inputs.compiled(plan.chosen.settings)) << summary(plan);
        ASSERT_EQ(plan.missing.size(), 1u);
        EXPECT_EQ(shadersOf(plan.missing.front(), false), best);
    }
    inputs.compiled = [&](const RenderSettings& way) { return shadersOf(way, false) == best; };
    const Plan same = makePlan(inputs, builtInCosts());
    EXPECT_EQ(shadersOf(same.chosen.settings, false), best);
    EXPECT_TRUE(same.missing.empty());
    inputs.compiled = [](const RenderSettings&) { return false; };
    const Plan none = makePlan(inputs, builtInCosts());
    EXPECT_EQ(shadersOf(none.chosen.settings, false), best) << "something has to be drawn";
}

// A finer one is wanted and not compiled. The only compiled one that is finer takes many times as long.
TEST(CompiledWays, WhatIsInUseStaysForAWhileIfItErrsLittleMore) {
    PlanInputs inputs = inputsOf(cube());
    inputs.views = {kOutside};
    inputs.scene.wanted.method = "slabs";
    inputs.scene.wanted.flip = 1;
    inputs.scene.wanted.slabs = 128; // the rate alone is left open
    inputs.scene.wanted.error = 0.02f;
    const Plan used = makePlan(inputs, builtInCosts());
    ASSERT_GT(used.chosen.settings.rate, 2u);
    inputs.before = used.chosen.settings;
    inputs.before_deviation_px = used.reference_deviation_px;
    inputs.compiled = [&](const RenderSettings& way) { return way.rate == 1 || way.rate == used.chosen.settings.rate; };
    const auto with = [&](double times_the_budget) {
        inputs.scene.wanted.error = float(used.chosen.error / times_the_budget);
        return makePlan(inputs, builtInCosts());
    };
    const auto rateOf = [](const Plan& plan) { return plan.chosen.settings.rate; };
    const Plan little = with(1.3);
    EXPECT_FALSE(little.missing.empty()) << summary(little);
    EXPECT_EQ(rateOf(little), used.chosen.settings.rate) << summary(little);
    EXPECT_EQ(rateOf(with(4)), 1u);
}

// The way in use is no longer kept because of what another would cost: it is the only one.
TEST(CompiledWays, OverloadAndManyViewsTakeCompiledRatesOnly) {
    for (const uint32_t objects : {0u, 3u}) {
        PlanInputs inputs = inputsOf(cube(5000, 3));
        inputs.scene.wanted.method = "slabs";
        inputs.scene.features.opaque = objects > 0;
        PlanView small = inputs.views.front();
        small.width /= 4, small.height /= 4;
        inputs.views.push_back(small);
        inputs.relaxed = 9;
        const Plan free = makePlan(inputs, builtInCosts());
        const std::set<uint32_t> rates{2, 4};
        inputs.compiled = [&](const RenderSettings& way) { return rates.contains(way.rate); };
        const Plan plan = makePlan(inputs, builtInCosts());
        EXPECT_TRUE(rates.contains(plan.chosen.settings.rate)) << summary(plan);
        EXPECT_GT(plan.relaxed, 0u);
        EXPECT_FALSE(plan.missing.empty());
        EXPECT_NE(free.chosen.settings.rate, plan.chosen.settings.rate) << "or it shows nothing";
    }
}

TEST(CompiledWays, TheNearestRateIsAFinerOneIfThereIs) {
    RenderSettings way;
    way.rate = 8;
    const auto of = [&](std::set<uint32_t> compiled) {
        return nearestCompiledRate(way, [=](const RenderSettings& one) { return compiled.contains(one.rate); });
    };
    EXPECT_EQ(of({4, 8, 12}), 8u);
    EXPECT_EQ(of({2, 4, 12}), 4u);
    EXPECT_EQ(of({12, 16}), 12u);
    EXPECT_EQ(of({}), 8u);
}

// Until everything is compiled, every eye of a running server has a compiled rate, and the plan's way is compiled.
TEST(CompiledWays, ARunningServerDrawsWithWhatIsCompiledAndTakesTheRestWhenItIsThere) {
    const Scene scene = cube();
    const Simulation simulation(scene);
    NothingCompiled ways;
    Planner planner(scene, builtInCosts(), 50, &ways);
    const Planner::Time start{seconds(1000)};
    RenderSettings dear = scene.render;
    dear.method = "tiles";
    ways.add(shadersOf(dear, false));
    planner.settings(simulation, {&kOutside, 1}, true, start);
    const RenderSettings then = planner.settings(simulation, {&kInside, 1}, false, start);
    EXPECT_TRUE(ways.has(then, false));
    RenderSettings own = then;
    own.rate = planner.rateOf(kInside, then, false);
    EXPECT_TRUE(ways.has(own, false));
    ASSERT_TRUE(ways.nextWanted());
    const WayShaders wanted = ways.nextWanted()->shaders;
    EXPECT_FALSE(planner.drawable(finer(then), true));
    ways.add(wanted);
    for (int s = 1; s < 6; ++s) planner.refresh(simulation, {&kInside, 1}, start + seconds(s));
    EXPECT_EQ(shadersOf(planner.plan().chosen.settings, false), wanted);
}

// Pictures stay as they were until something is compiled for what is asked for. Nobody waits for a driver.
TEST(CompiledWays, WhatIsAskedForIsDrawnOnceItIsCompiled) {
    Scene scene = cube();
    scene.render.method = "slabs";
    Simulation simulation(scene);
    NothingCompiled ways;
    Planner planner(scene, builtInCosts(), 50, &ways);
    int now = 1000;
    const auto plan = [&] {
        const RenderSettings settings =
            planner.settings(simulation, {&kOutside, 1}, true, Planner::Time(seconds(++now)));
        RenderSettings drawn = settings;
        if (const uint32_t rate = planner.rateOf(kOutside, settings)) drawn.rate = rate;
        return drawn;
    };
    const auto compile = [&] {
        while (const auto next = ways.nextWanted()) ways.add(next->shaders);
    };
    plan();
    compile();
    const auto set = [&](Set changes) {
        const Command command{1, 1, std::move(changes)};
        simulation.step({&command, 1});
        ASSERT_TRUE(simulation.refused().empty());
    };
    using Text = std::string;
    for (const Set& changes : {Set{{"render.scattering", Text("octaves")}},
                               {{"render.scattering", Text("single")}, {"render.method", Text("froxels")}},
                               {{"render.froxels.shadows", Text("hybrid")}},
                               {{"render.froxels.history", 0.5f}},
                               {{"render.method", Text("march")}},
                               {{"render.march.blur", Text("none")}},
                               {{"render.march.jitter", Text("opacity")}},
                               {{"render.method", Text("gradients")}},
                               {{"render.radiance.interpolation", Text("rbf")}}}) {
        const WayShaders before = shadersOf(plan(), false);
        set(changes);
        set({{"render.exposure", float(now)}});
        const RenderSettings meanwhile = plan();
        EXPECT_EQ(text(shadersOf(meanwhile, false)), text(before)) << changes.changes.back().path();
        EXPECT_EQ(meanwhile.exposure, simulation.now().render.exposure) << "no shader depends on it";
        ASSERT_TRUE(ways.nextWanted()) << changes.changes.back().path();
        compile();
        const RenderSettings after = plan();
        EXPECT_NE(text(shadersOf(after, false)), text(before)) << changes.changes.back().path();
        EXPECT_TRUE(ways.has(after, false));
        EXPECT_EQ(after.method, simulation.now().render.method);
    }
}

// The log's lines, from its beginning to its end.
class HeardLog {
public:
    HeardLog() : before_(spdlog::default_logger()) {
        spdlog::set_default_logger(
            std::make_shared<spdlog::logger>("heard", std::make_shared<spdlog::sinks::ostream_sink_st>(lines_)));
    }
    ~HeardLog() { spdlog::set_default_logger(before_); }
    std::string take() { return std::exchange(lines_, std::ostringstream()).str(); }

private:
    std::ostringstream lines_;
    std::shared_ptr<spdlog::logger> before_;
};

// Pictures whose error nobody knows, since nothing better is compiled: viewers are told at once, the log once.
TEST(CompiledWays, WhoIsDrawnOtherwiseThanPromisedIsTold) {
    const Scene scene = cube();
    const Simulation simulation(scene);
    HeardLog log;
    NothingCompiled ways;
    Planner planner(scene, builtInCosts(), 50, &ways);
    RenderSettings plain = scene.render;
    plain.method = "sphere";
    ways.add(shadersOf(plain, false));
    const Planner::Time start{seconds(1000)};
    planner.settings(simulation, {&kOutside, 1}, true, start);
    ASSERT_EQ(planner.plan().chosen.settings.method, "sphere");
    const std::string next = waitsFor(planner.plan());
    EXPECT_EQ(next, ways.nextWanted()->settings.method);
    const auto told = [&] { return sceneReport(simulation, planner.plan())->plan.text; };
    EXPECT_NE(told().find("until the shaders of " + next + " are compiled"), std::string::npos) << told();
    for (int s = 1; s < 10; ++s) planner.refresh(simulation, {&kOutside, 1}, start + seconds(s));
    EXPECT_EQ(log.take(), "");
    for (int s = 11; s < 20; ++s) planner.refresh(simulation, {&kOutside, 1}, start + seconds(s));
    const std::string line = log.take();
    EXPECT_NE(line.find("shaders of " + next + " are still being compiled"), std::string::npos) << line;
    EXPECT_EQ(std::ranges::count(line, '\n'), 1) << line;

    while (const auto wanted = ways.nextWanted()) ways.add(wanted->shaders);
    for (int s = 20; s < 25; ++s) planner.refresh(simulation, {&kOutside, 1}, start + seconds(s));
    EXPECT_EQ(planner.plan().chosen.settings.method, next);
    EXPECT_EQ(waitsFor(planner.plan()), "");
    EXPECT_EQ(told().find("until"), std::string::npos) << told();
    EXPECT_NE(log.take().find("shaders are compiled"), std::string::npos);
}

TEST(FarJump, APlanIsMadeAnewForAnEyeThatIsSuddenlyFarAway) {
    const Scene scene = cube();
    const Simulation simulation(scene);
    Planner planner(scene, builtInCosts(), 50);
    const Planner::Time start{seconds(1000)};
    const auto madeFor = [&](std::initializer_list<PlanView> views) {
        planner.settings(simulation, std::span(views.begin(), views.size()), false, start);
        return planner.inputs().views.front().pose.position;
    };
    EXPECT_EQ(madeFor({kOutside}), kOutside.pose.position);
    EXPECT_EQ(madeFor({kInside}), kInside.pose.position) << "into the medium";
    EXPECT_EQ(madeFor({kOutside}), kOutside.pose.position) << "out of it";
    const PlanView near = viewFrom({0, 2, 25}), far = viewFrom({0, 2, 80});
    EXPECT_EQ(madeFor({near}), kOutside.pose.position) << "a step costs no plan";
    EXPECT_EQ(madeFor({far}), far.pose.position);
    EXPECT_EQ(madeFor({far, kInside}), far.pose.position);
    EXPECT_EQ(madeFor({kInside, far}), far.pose.position) << "another order is no jump";
    EXPECT_EQ(madeFor({far, far}), far.pose.position);
}

// A device keeps some pipelines only: what has() says is drawn without waiting.
TEST(CompiledWays, WhatWasNotDrawnForAWhileIsForgottenButForSome) {
    CompiledWays ways;
    ways.setAll(false);
    ways.clear();
    RenderSettings way;
    way.method = "slabs";
    const CompiledWays::Clock::time_point now = CompiledWays::Clock::now();
    constexpr uint32_t kMany = CompiledWays::kMostUnused + 5;
    for (way.rate = 1; way.rate <= kMany; ++way.rate) ways.add(shadersOf(way, false));
    for (way.rate = 1; way.rate <= kMany; ++way.rate)
        ways.use(way, false, now - 2 * CompiledWays::kUnused + std::chrono::milliseconds(way.rate));
    const auto has = [&](uint32_t rate) {
        way.rate = rate;
        return ways.has(way, false);
    };
    for (uint32_t rate = 1; rate <= kMany; ++rate) EXPECT_TRUE(has(rate)) << rate;
    way.rate = 1;
    ways.use(way, false, now);
    way.rate = 100;
    ways.add(shadersOf(way, false));
    for (uint32_t rate = 1; rate <= kMany; ++rate) EXPECT_EQ(has(rate), rate == 1 || rate > 5) << rate;
    EXPECT_TRUE(has(100));
    // Lists of which no way is left are wanted anew.
    SceneFeatures foggy;
    foggy.fog = true;
    way.rate = 2;
    ways.add(foggy, shadersOf(way, false));
    EXPECT_TRUE(ways.follow(foggy));
    ways.use(way, false, now - 3 * CompiledWays::kUnused);
    EXPECT_TRUE(ways.follow({}));
    way.rate = 101;
    ways.add(shadersOf(way, false));
    EXPECT_FALSE(ways.follow(foggy));
    EXPECT_EQ(ways.wantedFeatures(), foggy);
}

} // namespace
} // namespace brume::compiled_ways_test
