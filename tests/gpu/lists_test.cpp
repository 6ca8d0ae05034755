// Lists of a scene that commands change while a renderer draws it.
#include "tests/gpu/fixture.h"
#include "tests/layer.h"

namespace brume::test::lists_test {
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
    renderer.drawOnly({.sun = true});
    after(Add{SceneList::fogs, {fog("fog.extinction", 0.05f), fog("fog.emission", glm::vec3(1))}});
    EXPECT_TRUE(after(Add{SceneList::lights, {}}) == none);
    Scene scene = bare();
    scene.fogs = {{.extinction = 0.05f}};
    renderer.drawOnly({.fog = true, .sun = true});
    EXPECT_TRUE(after(Set{}) == pictureOf(scene)) << "the fog without its emission";
    scene.fogs[0].emission = glm::vec3(1);
    scene.lights.push_back({.type = kPoint});
    renderer.drawOnly(featuresOf(simulation.now()));
    EXPECT_TRUE(after(Set{}) == pictureOf(scene));
    after(Remove{SceneList::fogs, 0});
    const std::vector<glm::vec4> more = after(Remove{SceneList::lights, 0});
    ASSERT_EQ(more.size(), none.size());
    double apart = 0;
    for (size_t i = 0; i < none.size(); ++i) apart = std::max(apart, double(glm::length(more[i] - none[i])));
    EXPECT_LT(apart, 1e-3) << "shaders for more than there is";
}

// Objects that move: shadows on the medium and on the ground follow, in a medium that rests. `tiles` keeps light on the
// particles, `slabs` looks it up.
class MovedObjectsTest : public GpuTest {
protected:
    static Scene withObjects(const char* method) {
        Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 0.35f), 1.6f);
        scene.simulation.paused = true;
        scene.render.method = method;
        scene.render.rate = 4, scene.render.slabs = 32;
        scene.render.shadow_size = 64, scene.render.shadow_slices = 17;
        scene.planes = {{.height = -3}};
        scene.boxes = {{.centre = {0, 3, 0}, .size = {2, 0.5f, 2}}, {.centre = {-2, 0, 1}}};
        scene.spheres = {{.centre = {2, 2, 0}, .radius = 0.5f}};
        return scene;
    }
    static double apart(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
        double sum = 0;
        for (size_t i = 0; i < a.size(); ++i) sum += double(glm::length(glm::vec3(a[i] - b[i])));
        return sum / double(a.size());
    }
};

TEST_F(MovedObjectsTest, AreDrawnAsIfTheSceneHadBegunSo) {
    BRUME_WHOLE_LAYER_ONLY();
    for (const char* method : {"slabs", "tiles"}) {
        Scene scene = withObjects(method);
        Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "objects");
        renderer.keepRadiance(true);
        const auto after = [&](CommandBody body) {
            const Command command{1, 1, std::move(body)};
            simulation.step({&command, 1});
            EXPECT_TRUE(simulation.refused().empty());
            const EyeRequest eye{kPose, kWidth, kHeight};
            submitAndWait(renderer, submission, simulation, {&eye, 1});
            return renderer.readRadiance();
        };
        const auto fresh = [&] { return render(device(), scene, kPose, kWidth, kHeight).pixels; };
        const std::vector<glm::vec4> first = after(Set{});
        EXPECT_TRUE(first == fresh()) << method;
        scene.boxes[0].centre = {1, 3, 1}, scene.boxes[1].yaw = 0.5f, scene.spheres[0].radius = 1;
        scene.planes[0].height = -2.5f, scene.boxes[1].albedo = {1, 0, 0};
        const std::vector<glm::vec4> moved = after(Set{{"box[0].centre", glm::vec3(1, 3, 1)},
                                                       {"box[1].yaw", 0.5f},
                                                       {"sphere[0].radius", 1.0f},
                                                       {"plane[0].height", -2.5f},
                                                       {"box[1].albedo", glm::vec3(1, 0, 0)}});
        EXPECT_TRUE(moved == fresh()) << method << ": " << apart(moved, fresh());
        EXPECT_GT(apart(moved, first), 1e-3);
        // Another number is drawn by the shaders for many objects: the same but for roundings.
        scene.boxes.push_back({.centre = {0, -1, 4}});
        const std::vector<glm::vec4> more =
            after(Add{SceneList::boxes, {{SceneList::boxes, "box.centre", glm::vec3(0, -1, 4)}}});
        EXPECT_LT(apart(more, fresh()), 1e-5) << method;
        EXPECT_GT(apart(more, moved), 1e-3);
        scene.boxes.pop_back();
        EXPECT_TRUE(after(Remove{SceneList::boxes, 2}) == moved) << method;
        scene.planes.clear(), scene.boxes.clear(), scene.spheres.clear();
        for (const SceneList list : {SceneList::planes, SceneList::boxes, SceneList::spheres})
            while (simulation.now().lists.size(list) > 0) after(Remove{list, 0});
        EXPECT_LT(apart(after(Set{}), fresh()), 1e-5) << method;
    }
}

// The first object of a scene needs other shaders, and a scene of [objects] has those.
TEST_F(MovedObjectsTest, TheFirstOneIsLeftOutWhereShadersKnowNone) {
    Scene scene = withObjects("slabs");
    scene.planes.clear(), scene.boxes.clear(), scene.spheres.clear();
    Simulation simulation(scene);
    Renderer renderer(device(), scene, simulation.capacity());
    Submission submission(device(), "objects");
    renderer.keepRadiance(true);
    const auto picture = [&] {
        const EyeRequest eye{kPose, kWidth, kHeight};
        submitAndWait(renderer, submission, simulation, {&eye, 1});
        return renderer.readRadiance();
    };
    renderer.drawOnly(featuresOf(simulation.now()));
    const std::vector<glm::vec4> none = picture();
    const Command add{1, 1, Add{SceneList::boxes, {}}};
    simulation.step({&add, 1});
    EXPECT_TRUE(picture() == none);
    renderer.drawOnly(featuresOf(simulation.now()));
    scene.boxes = {{}};
    EXPECT_LT(apart(picture(), render(device(), scene, kPose, kWidth, kHeight).pixels), 1e-5);
    EXPECT_GT(apart(picture(), none), 1e-4);
}

} // namespace
} // namespace brume::test::lists_test
