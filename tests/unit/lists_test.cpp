// Points, spots, fogs and objects that commands change, add and remove.
#include <gtest/gtest.h>

#include "tests/unit/simulation_scenes.h"

namespace brume {
namespace {

// Two elements of every list, over some particles.
Scene listScene() {
    Scene scene = cubeScene(10);
    scene.lights.push_back({.type = kPoint, .position = {1, 2, 3}});
    scene.lights.push_back({.type = kSpot, .position = {4, 5, 6}});
    scene.fogs = {{.extinction = 0.1f}, {.extinction = 0.2f}};
    scene.planes = {{.height = -2}, {.height = -1}};
    scene.boxes = {{.centre = {1, 0, 0}}, {.centre = {2, 0, 0}}};
    scene.spheres = {{.centre = {3, 0, 0}}, {.centre = {4, 0, 0}}};
    return scene;
}

// A simulation after one command; why it was refused, if it was.
struct After {
    After(const Scene& scene, CommandBody body) : simulation(scene) {
        give(simulation, {{.viewer = 7, .seq = 9, .body = std::move(body)}});
        if (simulation.refused().empty()) return;
        EXPECT_EQ(simulation.refused()[0].viewer, 7u);
        EXPECT_EQ(simulation.refused()[0].seq, 9u);
        why = simulation.refused()[0].why;
    }
    const SceneLists& lists() const { return simulation.now().lists; }
    Simulation simulation;
    std::string why;
};

TEST(ElementPaths, NameAnElementOrOneOfItsSettings) {
    const auto fog = elementPath("fog[12]"), key = elementPath("light[3].intensity");
    ASSERT_TRUE(fog && key);
    EXPECT_EQ(fog->list, SceneList::fogs);
    EXPECT_EQ(fog->element, 12u);
    EXPECT_EQ(fog->key, "");
    EXPECT_EQ(key->list, SceneList::lights);
    EXPECT_EQ(key->element, 3u);
    EXPECT_EQ(key->key, "intensity");
    for (const char* wrong : {"", "fog", "fog[", "fog[]", "fog[-1]", "fog[1", "fog[1]x", "fog[1].", "fog[ 1]",
                              "fog[1234567]", "boxes[0].size", "objects[0].centre", "foggy[0]", "fog[1x].extinction"})
        EXPECT_FALSE(elementPath(wrong)) << wrong;
}

TEST(ElementPaths, LeadToTheSettingsThatAreLive) {
    EXPECT_EQ(liveSetting("fog[3].extinction"), elementSetting(SceneList::fogs, "fog.extinction"));
    EXPECT_NE(liveSetting("fog[3].extinction"), nullptr);
    EXPECT_NE(liveSetting("light[0].axis"), nullptr);
    EXPECT_NE(liveSetting("light.to_light"), nullptr);
    for (const char* not_live : {"fog.extinction", "light[0].to_light", "light[0].irradiance", "fog[0].bogus", "fog[0]",
                                 "light.position", "fog[0].fog.extinction"})
        EXPECT_EQ(liveSetting(not_live), nullptr) << not_live;
    EXPECT_EQ(Change("fog[3].extinction", 1.0f).path(), "fog[3].extinction");
    EXPECT_EQ(Change(SceneList::fogs, "fog.extinction", 1.0f).path(), "fog.extinction");
    EXPECT_THROW(Change("fog[3].extinction", true), std::invalid_argument);
    EXPECT_THROW(Change(SceneList::fogs, "light.position", glm::vec3(0)), std::invalid_argument);
}

TEST(Lists, AnElementIsChanged) {
    const After fog(listScene(), Set{{"fog[1].extinction", 0.5f}, {"fog[1].phase", "droplets"}});
    EXPECT_EQ(fog.why, "");
    EXPECT_EQ(fog.lists().fogs[0].extinction, 0.1f);
    EXPECT_EQ(fog.lists().fogs[1].extinction, 0.5f);
    EXPECT_EQ(fog.lists().fogs[1].phase, "droplets");
    const After light(listScene(), Set{{"light[1].axis", glm::vec3(3, 0, 0)}, {"light[0].shadows", false}});
    EXPECT_EQ(light.why, "");
    EXPECT_EQ(light.lists().lights[1].axis, glm::vec3(1, 0, 0)) << "a unit vector";
    EXPECT_FALSE(light.lists().lights[0].shadows);
    EXPECT_TRUE(light.lists().lights[1].shadows);
    EXPECT_EQ(light.simulation.now().light.to_light, listScene().lights[0].to_light) << "it does not count";
}

TEST(Lists, AnObjectIsMovedTurnedAndColoured) {
    const After after(listScene(), Set{{"box[1].centre", glm::vec3(5, 6, 7)},
                                       {"box[1].size", glm::vec3(1, 2, -3)},
                                       {"box[0].yaw", 0.5f},
                                       {"sphere[0].radius", 2.0f},
                                       {"plane[1].albedo", glm::vec3(0.25f)},
                                       {"plane[1].structure", 2.0f},
                                       {"plane[0].structure_size", 3.0f}});
    EXPECT_EQ(after.why, "");
    EXPECT_EQ(after.lists().boxes[1], (Box{.centre = {5, 6, 7}, .size = {1, 2, float(limits::kLength.lo)}}));
    EXPECT_EQ(after.lists().boxes[0], (Box{.centre = {1, 0, 0}, .yaw = 0.5f}));
    EXPECT_EQ(after.lists().spheres[0], (Sphere{.centre = {3, 0, 0}, .radius = 2}));
    EXPECT_EQ(after.lists().planes[0], (Plane{.height = -2, .structure_size = 3}));
    EXPECT_EQ(after.lists().planes[1], (Plane{.height = -1, .albedo = glm::vec3(0.25f), .structure = 1}));
}

// Those of [objects] are no elements: they stay, behind the file's own.
TEST(Lists, ObjectsThatWereLaidOutStayAndCount) {
    Scene scene = listScene();
    scene.laid_out_boxes = 1, scene.laid_out_spheres = 2; // the second box, and both spheres
    EXPECT_EQ(After(scene, Set{{"box[1].yaw", 1.0f}}).why, "there is no box[1]: the last one is box[0]");
    EXPECT_EQ(After(scene, Remove{SceneList::spheres, 0}).why, "there is no sphere[0]: there is none at all");
    const After moved(scene, Set{{"box[0].centre", glm::vec3(9, 0, 0)}}), more(scene, Add{SceneList::spheres, {}});
    Scene now = scene;
    setObjects(now, moved.lists());
    EXPECT_EQ(now.boxes, (std::vector<Box>{{.centre = {9, 0, 0}}, {.centre = {2, 0, 0}}}));
    EXPECT_EQ(now.spheres, scene.spheres);
    setObjects(now, more.lists());
    EXPECT_EQ(now.spheres, (std::vector<Sphere>{{}, {.centre = {3, 0, 0}}, {.centre = {4, 0, 0}}}));
    EXPECT_EQ(now.boxes, scene.boxes);
    scene.boxes.resize(size_t(limits::kObjects.hi) - 2);
    EXPECT_EQ(After(scene, Add{SceneList::boxes, {}}).why,
              "4097 boxes and spheres, 4096 is the most: remove one first");
    EXPECT_EQ(After(scene, Add{SceneList::planes, {}}).why, "");
}

TEST(Lists, APointBecomesASpotAndBack) {
    const After spot(listScene(), Set{{"light[0].type", "spot"}, {"light[0].outer", 1.0f}});
    EXPECT_EQ(spot.why, "");
    EXPECT_EQ(spot.lists().lights[0].type, kSpot);
    EXPECT_EQ(After(listScene(), Set{{"light[1].type", "point"}}).lists().lights[1].type, kPoint);
}

TEST(Lists, WhatCannotBeIsRefusedInOneLineAndChangesNothing) {
    const std::pair<CommandBody, const char*> cases[]{
        {Set{{"fog[2].extinction", 1.0f}}, "there is no fog[2]: the last one is fog[1]"},
        {Set{{"light[0].axis", glm::vec3(1, 0, 0)}}, "light[0] is a point, which has no axis"},
        {Set{{"light[0].type", "directional"}}, "light[0] is a point or a spot"},
        {Set{{"fog[0].lo", 5.0f}, {"fog[0].hi", 4.0f}}, "fog[0]: lo must be below hi"},
        {Set{{"light[1].inner", 1.0f}}, "light[1]: inner must be below outer"},
        {Set{{"fog[0].extinction", 1.0f}, {"medium.falloff", 3.0f}, {"fog[9].falloff", 1.0f}},
         "there is no fog[9]: the last one is fog[1]"},
        {Remove{SceneList::lights, 2}, "there is no light[2]: the last one is light[1]"},
        {Add{SceneList::lights, {{SceneList::fogs, "fog.extinction", 1.0f}}},
         "fog.extinction is no setting of a new light"},
    };
    for (const auto& [body, why] : cases) {
        const After refused(listScene(), body), untouched(listScene(), Set{});
        EXPECT_EQ(refused.why, why);
        EXPECT_EQ(refused.simulation.stateHash(), untouched.simulation.stateHash()) << why;
    }
    Scene empty = listScene();
    empty.fogs.clear();
    EXPECT_EQ(After(empty, Remove{SceneList::fogs, 0}).why, "there is no fog[0]: there is none at all");
}

TEST(Lists, NumbersAreBroughtIntoTheirRange) {
    const After after(listScene(), Set{{"fog[0].albedo", glm::vec3(2, -1, 0.5f)}, {"light[0].range", -1.0f}});
    EXPECT_EQ(after.lists().fogs[0].albedo, glm::vec3(1, 0, 0.5f));
    EXPECT_EQ(after.lists().lights[0].range, 0);
}

TEST(Lists, ElementsAreAddedBehindAndRemoved) {
    const After fog(listScene(), Add{SceneList::fogs, {{SceneList::fogs, "fog.radius", 3.0f}}});
    ASSERT_EQ(fog.lists().fogs.size(), 3u);
    EXPECT_EQ(fog.lists().fogs[2].radius, 3);
    EXPECT_EQ(fog.lists().fogs[2].extinction, Fog().extinction);
    const After light(listScene(), Add{SceneList::lights, {}});
    ASSERT_EQ(light.lists().lights.size(), 3u);
    EXPECT_EQ(light.lists().lights[2].type, kPoint);
    const After fewer(listScene(), Remove{SceneList::fogs, 0});
    ASSERT_EQ(fewer.lists().fogs.size(), 1u);
    EXPECT_EQ(fewer.lists().fogs[0].extinction, 0.2f);
}

TEST(Lists, AreNoLongerThanASceneFileAllows) {
    Scene scene = listScene();
    scene.fogs.resize(size_t(limits::kFogs.hi));
    EXPECT_EQ(After(scene, Add{SceneList::fogs, {}}).why, "there are 4 already, 4 is the most: remove one first");
    scene.lights.resize(1);
    scene.lights.resize(1 + size_t(limits::kLocalLights.hi), {.type = kPoint, .shadows = false});
    EXPECT_EQ(After(scene, Add{SceneList::lights, {}}).why,
              "there are 1024 already, 1024 is the most: remove one first");
}

TEST(Lists, ShadowsAmongParticlesAreBounded) {
    Scene scene = listScene();
    scene.lights.resize(1 + size_t(limits::kShadowedLights.hi), {.type = kPoint});
    const Add lit{SceneList::lights, {}}, unshadowed{SceneList::lights, {{SceneList::lights, "light.shadows", false}}};
    EXPECT_EQ(After(scene, lit).why,
              "65 points and spots with shadows among particles, 64 is the most: others without shadows");
    EXPECT_EQ(After(scene, unshadowed).why, "");
    scene.medium.layout = Layout::none;
    EXPECT_EQ(After(scene, lit).why, "") << "nothing has to be stored for lights that fog alone dims";
}

// Whatever differs in the lists differs in the hash; Restart brings back the scene's own.
TEST(Lists, AreInTheHashAndComeBackWithRestart) {
    const uint64_t before = After(listScene(), Set{}).simulation.stateHash();
    for (const SceneList list : kSceneLists) {
        for (const SceneSetting* setting : liveSettings(list)) {
            SceneLists lists = listsOf(listScene());
            SettingValue value = valueOf(*setting, partsOf(lists, list, 1)); // element 1 is a spot, or a fog
            std::visit(
                [&]<class T>(T& v) {
                    if constexpr (std::is_same_v<T, bool>) v = !v;
                    if constexpr (std::is_same_v<T, float>) v = v > 1 ? v - 1 : v < -1 ? v + 1 : v + 0.1f;
                    if constexpr (std::is_same_v<T, glm::vec3>) v = glm::vec3(0.5f, 0.25f, 0.125f);
                    if constexpr (std::is_same_v<T, std::string>) v = v == kSpot ? kPoint : "rayleigh";
                },
                value);
            const std::string path = std::string(nameOf(list)) + "[1]." + std::string(setting->key());
            After changed(listScene(), Set{{path, value}});
            EXPECT_EQ(changed.why, "") << path;
            EXPECT_NE(changed.simulation.stateHash(), before) << path;
            EXPECT_GT(changed.simulation.settingsVersion(), 0u);
            give(changed.simulation, {command(Restart{})});
            Simulation fresh(listScene());
            EXPECT_EQ(changed.simulation.listsHash(), fresh.listsHash()) << path;
        }
        EXPECT_NE(After(listScene(), Add{list, {}}).simulation.stateHash(), before);
        EXPECT_NE(After(listScene(), Remove{list, 1}).simulation.stateHash(), before);
    }
}

// A light that goes round is elsewhere at every tick, and its hash says so.
TEST(Lists, TheHashFollowsALightThatOrbits) {
    Scene scene = listScene();
    scene.lights[1].orbit = 1;
    Simulation orbits(scene), moved(scene);
    give(moved, {command(Set{{"light[0].position", glm::vec3(1, 2, 3)}})});
    give(orbits, {});
    EXPECT_EQ(moved.stateHash(), orbits.stateHash()) << "where it was already";
    give(moved, {command(Set{{"light[0].position", glm::vec3(1, 2, 3)}})});
    give(orbits, {});
    EXPECT_NE(moved.stateHash(), orbits.stateHash());
}

} // namespace
} // namespace brume
