// Lists of a scene that commands change while a renderer draws it.
#include "tests/gpu/fixture.h"

namespace brume::test {
namespace {

constexpr uint32_t kWidth = 96, kHeight = 54;
const Pose kPose = lookAt({2, 3, 14}, {0, 0, 0}, 0.9f);

class ListsTest : public GpuTest {
protected:
    static Scene bare() {
        Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 0.35f), 1.6f);
        scene.simulation.paused = true;
        scene.render.method = "slabs";
        scene.render.rate = 4;
        scene.render.slabs = 32;
        scene.render.shadow_size = 64;
        scene.render.shadow_slices = 17;
        return scene;
    }
    std::vector<glm::vec4> after(CommandBody body) {
        const Command command{1, 1, std::move(body)};
        simulation.step({&command, 1});
        EXPECT_TRUE(simulation.refused().empty());
        const EyeRequest eye{kPose, kWidth, kHeight};
        submitAndWait(renderer, submission, simulation, {&eye, 1});
        return renderer.readRadiance();
    }
    static std::vector<glm::vec4> pictureOf(const Scene& scene) {
        return render(device(), scene, kPose, kWidth, kHeight).pixels;
    }

    Simulation simulation{bare()};
    Renderer renderer{device(), bare(), simulation.capacity()};
    Submission submission{device(), "lists"};
};

// The first one needs other shaders, and without the last one those before draw again.
TEST_F(ListsTest, AreDrawnAsIfTheSceneHadBegunSo) {
    renderer.keepRadiance(true);
    Scene scene = bare();
    const std::vector<glm::vec4> none = after(Set{});
    EXPECT_TRUE(none == pictureOf(scene));
    scene.fogs = {{.extinction = 0.05f, .centre = {0, 1, 0}, .radius = 6}};
    const auto fog = [](const char* key, SettingValue value) { return Change(SceneList::fogs, key, std::move(value)); };
    EXPECT_TRUE(after(Add{SceneList::fogs,
                          {fog("fog.extinction", 0.05f), fog("fog.centre", glm::vec3(0, 1, 0)),
                           fog("fog.radius", 6.0f)}}) == pictureOf(scene));
    scene.lights.push_back({.type = kPoint, .position = {3, 2, 1}});
    EXPECT_TRUE(after(Add{SceneList::lights, {Change(SceneList::lights, "light.position", glm::vec3(3, 2, 1))}}) ==
                pictureOf(scene));
    scene.fogs[0].extinction = 0.2f;
    EXPECT_TRUE(after(Set{{"fog[0].extinction", 0.2f}}) == pictureOf(scene));
    scene.fogs.clear();
    EXPECT_TRUE(after(Remove{SceneList::fogs, 0}) == pictureOf(scene));
    EXPECT_TRUE(after(Remove{SceneList::lights, 0}) == none);
}

// Until shaders for what is there are compiled, those before draw what they can.
TEST_F(ListsTest, WhatShadersAreNotMadeForIsLeftOut) {
    renderer.keepRadiance(true);
    const auto fog = [](const char* key, SettingValue value) { return Change(SceneList::fogs, key, std::move(value)); };
    const std::vector<glm::vec4> none = after(Set{});
    renderer.draws({});
    after(Add{SceneList::fogs, {fog("fog.extinction", 0.05f), fog("fog.emission", glm::vec3(1))}});
    EXPECT_TRUE(after(Add{SceneList::lights, {}}) == none);
    Scene scene = bare();
    scene.fogs = {{.extinction = 0.05f}};
    renderer.draws({.fog = true});
    EXPECT_TRUE(after(Set{}) == pictureOf(scene)) << "the fog without its emission";
    scene.fogs[0].emission = glm::vec3(1);
    scene.lights.push_back({.type = kPoint});
    renderer.draws(featuresOf(simulation.now().lists));
    EXPECT_TRUE(after(Set{}) == pictureOf(scene));
    after(Remove{SceneList::fogs, 0});
    const std::vector<glm::vec4> more = after(Remove{SceneList::lights, 0});
    ASSERT_EQ(more.size(), none.size());
    double apart = 0;
    for (size_t i = 0; i < none.size(); ++i) apart = std::max(apart, double(glm::length(more[i] - none[i])));
    EXPECT_LT(apart, 1e-3) << "shaders for more than there is";
}

} // namespace
} // namespace brume::test
