// Hundreds of boxes and spheres against the double-precision reference: the sun's shafts between them, and lamps.
#include <gtest/gtest.h>

#include "common/object_layout.h"
#include "server/inputs/objects.h"
#include "tests/gpu/judged.h"

namespace brume::test::many_objects_test {
namespace {

constexpr double kJoined = 2.5e-2;

class ManyObjectsTest : public JudgedTest {
protected:
    static Scene foggy(const char* layout, uint32_t count) {
        Scene scene;
        scene.medium.layout = Layout::none;
        scene.planes = {{0, glm::vec3(0.3f)}};
        scene.lights = {Light{}};
        scene.fogs = {{.extinction = 0.02f, .falloff = 0.06f}};
        scene.objects = {.layout = layout, .count = count};
        const LaidOut laid_out = layOut(scene.objects);
        scene.boxes = laid_out.boxes;
        scene.spheres = laid_out.spheres;
        for (Box& box : scene.boxes) box.albedo = glm::vec3(0);
        for (Sphere& sphere : scene.spheres) sphere.albedo = glm::vec3(0);
        scene.planes[0].albedo = glm::vec3(0);
        scene.render.rate = 2;
        scene.render.slabs = 128;
        return scene;
    }
};

// Of the objects that light the medium by what they reflect: the largest and brightest, in the same order everywhere.
TEST(ReflectingObjects, AreThoseThatReflectMost) {
    Scene scene;
    scene.planes = {{0, glm::vec3(1)}};
    scene.boxes = {{{}, glm::vec3(0.1f), 0, glm::vec3(1)}, {{}, glm::vec3(10), 0, glm::vec3(0)}};
    for (int i = 0; i < 20; ++i) scene.spheres.push_back({{}, float(1 + i % 10), glm::vec3(0.5f)});
    const std::vector<uint32_t> most = reflectingObjects(opaqueObjects(scene)); // spheres come third, from index 3 on
    const std::vector<uint32_t> expected{12, 22, 11, 21, 10, 20, 9, 19, 8, 18, 7, 17, 6, 16, 5, 15};
    EXPECT_EQ(most, expected);
    scene.spheres.clear();
    EXPECT_EQ(reflectingObjects(opaqueObjects(scene)), std::vector<uint32_t>{1}); // black ones reflect nothing
}

TEST_F(ManyObjectsTest, ShaftsOfTheSun) {
    Scene scene = foggy(kAtrium, 150);
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.4f, 0.8f, 0.25f));
    judge(scene, {lookAt({15, 8, 5}, {-8, 6, -3}, 0.9f)});
}

TEST_F(ManyObjectsTest, LampsInAStreet) {
    Scene scene = foggy(kStreet, 400);
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
    scene.lights.clear();
    for (const float z : {70.0f, 54.0f, 38.0f})
        scene.lights.push_back({.type = kPoint, .position = {6.8f, 4.6f, z}, .range = 30, .radius = 0.1f});
    judge(scene, {lookAt({-2, 2, 84}, {4, 4, 50}, 0.9f)});
}

// Twice as many objects as there is room for on a ray: thin bars one behind the other. What lies between those that are
// joined counts as shadow.
TEST_F(ManyObjectsTest, MoreShadowsOnARayThanAreKeptApart) {
    Scene scene = foggy(kNoObjects, 0);
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.3f, 1, 0.1f));
    for (int i = 0; i < 2 * int(gpu::kMostShadows); ++i)
        scene.boxes.push_back({{0, 6, -0.5f * float(i)}, {8, 0.1f, 0.1f}, 0, glm::vec3(0.5f)});
    scene.render.slabs = 256;
    judge(scene, {lookAt({0, 2, 10}, {0, 3, -40}, 0.9f)}, kJoined);
}

} // namespace
} // namespace brume::test::many_objects_test
