// Changes that are taken back.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/sim/state_bytes.h"
#include "server/sim/undo.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::undo_test {
namespace {

Scene someLists() {
    Scene scene = cubeScene(10);
    scene.lights.push_back({.type = kSpot, .position = {4, 5, 6}, .inner = 0.2f, .outer = 0.4f});
    scene.fogs = {{.extinction = 0.1f}, {.extinction = 0.2f}, {.extinction = 0.3f}};
    return scene;
}

// Lets time pass, so that two changes are not one drag.
void wait(Simulation& simulation, int ticks = 40) {
    for (int i = 0; i < ticks; ++i) simulation.step({});
}

std::string refusalOf(Simulation& simulation, CommandBody body) {
    give(simulation, {command(std::move(body))});
    return simulation.refused().empty() ? "" : simulation.refused()[0].why;
}

void change(Simulation& simulation, CommandBody body) {
    EXPECT_EQ(refusalOf(simulation, std::move(body)), "");
    wait(simulation);
}

uint64_t settingsOf(const Simulation& simulation) {
    SceneNow now = simulation.now();
    uint64_t sum = hashOf(now.lists);
    for (const SceneSetting* setting : liveSettings())
        sum = sum * 31 + std::hash<std::string>()(std::visit(
                             []<class T>(const T& v) -> std::string {
                                 if constexpr (std::is_same_v<T, glm::vec3>)
                                     return fmt::format("{} {} {}", v.x, v.y, v.z);
                                 else
                                     return fmt::format("{}", v);
                             },
                             valueOf(*setting, partsOf(now))));
    return sum;
}

TEST(Undo, TakesBackEveryKindOfChangeFromTheNewestOn) {
    Simulation simulation(someLists());
    const std::vector<std::pair<CommandBody, const char*>> changes{
        {Set{{"medium.extinction", 3.5f}}, "medium.extinction back to 15"},
        {Set{{"light.irradiance", glm::vec3(1, 2, 3)}}, "light.irradiance back to [10, 10, 10]"},
        {Set{{"medium.anisotropy", 0.5f}, {"medium.asymmetry", 0.25f}}, "medium.anisotropy and 1 more back"},
        {Set{{"fog[1].extinction", 0.9f}}, "fog[1].extinction back to 0.2"},
        {Set{{"light[0].inner", 0.3f}, {"light[0].type", "point"}}, "light[0].inner and 1 more back"},
        {Add{SceneList::fogs, {{SceneList::fogs, "fog.radius", 2.0f}}}, "fog[3] away again"},
        {Remove{SceneList::fogs, 1}, "fog[1] back"},
        {Remove{SceneList::lights, 0}, "light[0] back"},
        {Set{{"simulation.paused", true}}, "simulation.paused back to false"},
        {Set{{"render.method", std::string("slabs")}}, "render.method back to sphere"}};
    std::vector<uint64_t> states{settingsOf(simulation)};
    for (const auto& [body, text] : changes) {
        change(simulation, body);
        EXPECT_EQ(simulation.undoText(), text);
        states.push_back(settingsOf(simulation));
        EXPECT_NE(states.back(), states[states.size() - 2]) << text;
    }
    for (size_t i = states.size() - 1; i-- > 0;) {
        const uint64_t version = simulation.settingsVersion();
        EXPECT_EQ(refusalOf(simulation, Undo{true}), "");
        EXPECT_EQ(settingsOf(simulation), states[i]) << changes[i].second;
        EXPECT_GT(simulation.settingsVersion(), version) << "viewers are told";
    }
    EXPECT_EQ(simulation.undoText(), "");
    EXPECT_EQ(refusalOf(simulation, Undo{true}), "there is nothing to undo: pushes, set particles and restarts stay");
}

TEST(Undo, TakesTheVolumeBack) {
    Scene still = cubeScene(10);
    still.simulation.spring = 1000;
    still.simulation.viscosity = 60;
    Simulation moved(still), other(still);
    change(moved, MoveVolume{{1, 0, 0}});
    change(moved, MoveVolume{{0, 5, 0}});
    EXPECT_EQ(moved.undoText(), "the medium back to where it was");
    EXPECT_EQ(refusalOf(moved, Undo{}), "");
    change(other, MoveVolume{{1, 0, 0}});
    wait(moved, 600), wait(other, 600);
    EXPECT_NEAR(moved.bounds().lo.y, other.bounds().lo.y, 1e-3f);
    EXPECT_NEAR(moved.bounds().lo.x, other.bounds().lo.x, 1e-3f);
}

TEST(Undo, TakesADragForOneChange) {
    Simulation simulation(someLists());
    change(simulation, Set{{"medium.falloff", 2.0f}});
    for (const float value : {3.0f, 4.0f, 5.0f}) {
        give(simulation, {command(Set{{"medium.extinction", value}})});
        wait(simulation, 3);
    }
    EXPECT_EQ(simulation.undoText(), "medium.extinction back to 15");
    give(simulation, {command(Undo{})});
    EXPECT_EQ(simulation.now().medium.extinction, 15);
    EXPECT_EQ(simulation.now().medium.falloff, 2);
    give(simulation, {command(Set{{"medium.falloff", 3.0f}})});
    EXPECT_EQ(simulation.undoText(), "medium.falloff back to 2") << "what was undone between ends a drag";
    wait(simulation);
    give(simulation, {command(Set{{"medium.falloff", 3.0f}})});
    EXPECT_EQ(simulation.undoText(), "medium.falloff back to 2") << "what changes nothing is no change";
}

TEST(Undo, LeavesOperatorsChangesToOperators) {
    Simulation simulation(someLists());
    change(simulation, Set{{"medium.extinction", 3.0f}});
    change(simulation, Set{{"render.exposure", 2.0f}});
    EXPECT_EQ(refusalOf(simulation, Undo{false}), "only an operator may undo that: render.exposure back to 1");
    EXPECT_EQ(simulation.now().render.exposure, 2);
    EXPECT_EQ(refusalOf(simulation, Undo{true}), "");
    EXPECT_EQ(refusalOf(simulation, Undo{false}), "");
    EXPECT_EQ(simulation.now().medium.extinction, 15);
}

TEST(Undo, KeepsSoManyChangesAndNoneOfBeforeARestart) {
    Simulation simulation(someLists());
    for (size_t i = 0; i < kMostUndone + 5; ++i) change(simulation, Set{{"medium.extinction", 20 + float(i)}});
    size_t undone = 0;
    while (!simulation.undoText().empty() && undone < 100) {
        give(simulation, {command(Undo{})});
        ++undone;
    }
    EXPECT_EQ(undone, kMostUndone);
    EXPECT_EQ(simulation.now().medium.extinction, 24);
    change(simulation, Set{{"medium.extinction", 1.0f}});
    give(simulation, {command(Impulse{.origin = {0, 0, 20}})});
    EXPECT_EQ(simulation.undoText(), "medium.extinction back to 24") << "a push stays, and is passed over";
    give(simulation, {command(Restart{})});
    EXPECT_EQ(simulation.undoText(), "");
}

TEST(Undo, ARefusedChangeIsNone) {
    Simulation simulation(someLists());
    EXPECT_NE(refusalOf(simulation, Set{{"fog[7].extinction", 1.0f}}), "");
    EXPECT_NE(refusalOf(simulation, Remove{SceneList::fogs, 7}), "");
    EXPECT_EQ(simulation.undoText(), "");
}

// Of every kind of change; broken bytes are refused.
TEST(Undo, IsPartOfASavedState) {
    Simulation first(someLists());
    change(first, MoveVolume{{1, 2, 3}});
    change(first, Set{{"medium.extinction", 3.0f}, {"render.method", std::string("slabs")}});
    change(first, Set{{"fog[1].centre", glm::vec3(1, 2, 3)}});
    change(first, Add{SceneList::boxes, {}});
    change(first, Remove{SceneList::lights, 0});
    change(first, Remove{SceneList::fogs, 1});
    std::vector<std::byte> bytes;
    first.save(bytes);
    Simulation second(someLists());
    change(second, Set{{"medium.falloff", 3.0f}});
    second.load(bytes);
    for (int i = 0; i < 7; ++i) {
        EXPECT_EQ(second.undoText(), first.undoText());
        give(first, {command(Undo{true})});
        give(second, {command(Undo{true})});
        EXPECT_EQ(second.stateHash(), first.stateHash());
        EXPECT_EQ(settingsOf(second), settingsOf(first));
    }
    EXPECT_EQ(first.undoText(), "");
    for (size_t cut = 1; cut < 300; cut += 7) {
        Simulation third(someLists());
        EXPECT_THROW(third.load(std::span(bytes).first(bytes.size() - cut)), StateError);
    }
}

} // namespace
} // namespace brume::undo_test
