// Places of many objects: their number, their size, and what a smaller count leaves out.
#include <gtest/gtest.h>

#include "common/object_layout.h"
#include "common/scene_text.h"
#include "tests/unit/scene_file.h"

namespace brume {
namespace {

struct Place {
    const char* name;
    glm::vec3 size; // m
};
constexpr Place kAll[] = {
    {kCourtyard, {70, 15, 29}}, {kStreet, {50, 30, 174}}, {kIslands, {95, 65, 95}}, {kAtrium, {38, 20, 24}}};

TEST(ObjectLayout, HasAsManyObjectsAsAsked) {
    for (const Place& place : kAll)
        for (const uint32_t count : {0u, 1u, 10u, 300u, 1000u, 4096u}) {
            const LaidOut out = layOut({.layout = place.name, .count = count});
            EXPECT_EQ(out.boxes.size() + out.spheres.size(), count) << place.name;
        }
    EXPECT_TRUE(layOut({}).boxes.empty());
}

TEST(ObjectLayout, FillsItsSizeAndNoMore) {
    for (const Place& place : kAll) {
        SCOPED_TRACE(place.name);
        const glm::vec3 centre{10, 3, -20};
        const LaidOut out = layOut({.layout = place.name, .count = 4096, .centre = centre});
        glm::vec3 lo(1e9f), hi(-1e9f);
        for (const Box& box : out.boxes) {
            EXPECT_TRUE(glm::all(glm::greaterThan(box.size, glm::vec3(0))));
            lo = glm::min(lo, box.centre - box.size / 2.0f), hi = glm::max(hi, box.centre + box.size / 2.0f);
        }
        for (const Sphere& sphere : out.spheres) {
            EXPECT_GT(sphere.radius, 0);
            lo = glm::min(lo, sphere.centre - sphere.radius), hi = glm::max(hi, sphere.centre + sphere.radius);
        }
        EXPECT_GE(lo.y, centre.y - 1e-3f); // on the ground
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LE(hi[axis] - lo[axis], 1.1f * place.size[axis]) << axis;
            EXPECT_GE(hi[axis] - lo[axis], 0.6f * place.size[axis]) << axis;
        }
    }
}

TEST(ObjectLayout, ASmallerCountLeavesOutTheLastOnes) {
    for (const char* name : {kCourtyard, kStreet, kAtrium}) {
        const LaidOut all = layOut({.layout = name, .count = 1000}), some = layOut({.layout = name, .count = 200});
        for (size_t i = 0; i < some.boxes.size(); ++i) EXPECT_EQ(some.boxes[i].centre, all.boxes[i].centre) << name;
        for (size_t i = 0; i < some.spheres.size(); ++i) EXPECT_EQ(some.spheres[i].radius, all.spheres[i].radius);
    }
}

TEST(ObjectLayout, IsPartOfSceneFiles) {
    const Scene scene = loadScene(test::written("[objects]\nlayout = \"street\"\ncount = 300\n[[box]]\n"));
    EXPECT_EQ(scene.boxes.size() + scene.spheres.size(), 301u);
    EXPECT_EQ(scene.boxes.front().size, glm::vec3(1)); // the file's
    EXPECT_NE(test::errorOf("[objects]\nlayout = \"forest\"\n").find("courtyard"), std::string::npos);
    const std::string too_many = test::errorOf("[objects]\nlayout = \"street\"\ncount = 4096\n[[box]]\n");
    EXPECT_NE(too_many.find("4097 boxes and spheres; allowed: up to 4096"), std::string::npos) << too_many;
}

// A saved scene says the layout again, not its objects.
TEST(ObjectLayout, IsSavedAsItself) {
    const std::string text =
        sceneToml(loadScene(test::written("[objects]\nlayout = \"atrium\"\ncount = 500\nseed = 4\n[[sphere]]\n")));
    EXPECT_LT(text.size(), 2000u);
    const Scene again = loadScene(test::written(text));
    EXPECT_EQ(again.boxes.size() + again.spheres.size(), 501u);
    EXPECT_EQ(again.objects.seed, 4u);
}

} // namespace
} // namespace brume
