// Where viewers stand within a place, and how much of what they see lies in the data that viewers share.
#include <cmath>
#include <cstdio>
#include <fstream>

#include <gtest/gtest.h>

#include "server/inputs/world_box.h"
#include "server/sim/solids.h"
#include "tests/bench/on_device.h"
#include "tools/bench/stand.h"
#include "tools/bench/sweep.h"
#include "tools/reference/obstacle_tree.h"

namespace brume::bench::stand_test {
namespace {

struct Place {
    Scene scene;
    Simulation simulation;

    explicit Place(const std::string& name, uint32_t ticks = 0) : scene(sceneOf({.scene = name})), simulation(scene) {
        for (uint32_t i = 0; i < ticks; ++i) simulation.step({});
    }
    std::vector<Pose> poses(const Stand& stand, uint32_t viewers) const {
        return posesOf({.viewers = viewers, .stand = stand}, scene, simulation);
    }
};

Bounds3 withLamps(Bounds3 box, const Scene& scene, double most) {
    for (const Light& light : scene.lights) {
        if (!isLocal(light)) continue;
        const double reach = light.range > 0 ? std::min(double(light.range), most) : most;
        box.add({glm::dvec3(light.position) - reach, glm::dvec3(light.position) + reach});
    }
    return box;
}

// The part of the slices in front of surfaces that lie in the box of shared data: 16x9 rays of each viewer, and slices
// as of server/methods/froxels/froxel_volume.h.
double partInside(const Place& place, const std::vector<Pose>& poses) {
    const reference::World world = reference::worldOf(place.scene, {});
    const reference::ObstacleTree obstacles(world.obstacles);
    const Bounds3 objects = placeBounds(place.scene, place.simulation.bounds()),
                  shared = withLamps(objects, place.scene, kLitAround),
                  seen = withLamps(objects, place.scene, kSeenAround);
    constexpr int kSlices = 128;
    uint64_t inside = 0, all = 0;
    for (const Pose& pose : poses) {
        const glm::dvec3 eye = pose.position;
        const double near = 0.05, far = glm::length(glm::max(glm::abs(eye - seen.lo), glm::abs(eye - seen.hi)));
        const double growth = std::log2(16) / kSlices, unit = (far - near) / 15;
        const auto face = [&](double f) { return near + unit * (std::exp2(growth * f) - 1); };
        const double high = std::tan(0.5 * double(pose.fov_y)), wide = high * 16 / 9;
        for (int y = 0; y < 9; ++y)
            for (int x = 0; x < 16; ++x) {
                const glm::vec3 in_view((x + 0.5 - 8) / 8 * wide, (y + 0.5 - 4.5) / 4.5 * high, -1);
                const glm::dvec3 dir(pose.orientation * in_view); // of view depth 1
                const double end = obstacles.nearest({.origin = eye, .direction = glm::normalize(dir)}).t;
                for (int s = 0; s < kSlices && face(s) * glm::length(dir) <= end; ++s) {
                    const glm::dvec3 at = eye + face(s + 0.5) * dir;
                    ++all;
                    inside +=
                        glm::all(glm::greaterThanEqual(at, shared.lo)) && glm::all(glm::lessThanEqual(at, shared.hi));
                }
            }
    }
    return double(inside) / double(all);
}

TEST(Stand, InsideNobodyIsInASolidAndAllAreWithinTheBounds) {
    for (const char* name : {"courtyard", "street", "islands", "dusty-room", "smoke-spots"}) {
        const Place place(name, 600);
        const Bounds3 bounds = placeBounds(place.scene, place.simulation.bounds());
        const std::vector<Pose> poses = place.poses({.inside = true}, 16);
        ASSERT_EQ(poses.size(), 16u) << name;
        for (const Pose& pose : poses) {
            const glm::dvec3 eye = pose.position;
            EXPECT_TRUE(glm::all(glm::greaterThanEqual(eye, bounds.lo)) && glm::all(glm::lessThanEqual(eye, bounds.hi)))
                << name;
            for (const Box& box : place.scene.boxes) {
                EXPECT_FALSE(depthIn(solidOf(box), eye)) << name;
                EXPECT_GE(glm::length(offFrom(solidOf(box), eye)), 1 - 1e-5) << name;
            }
            for (const Sphere& sphere : place.scene.spheres) {
                EXPECT_GE(glm::distance(glm::dvec3(sphere.centre), eye), double(sphere.radius) + 1 - 1e-5) << name;
            }
            if (!place.scene.planes.empty()) {
                EXPECT_NEAR(eye.y, place.scene.planes.front().height + 1.7, 1e-5) << name;
            }
        }
        const std::vector<Pose> four = place.poses({.inside = true}, 4);
        for (size_t i = 0; i < four.size(); ++i) EXPECT_EQ(four[i].position, poses[i].position) << name;
    }
}

// Where viewers go round a place, most of what they see is outside of it, and none of it is shared.
TEST(Stand, InsideMostOfWhatIsSeenIsShared) {
    for (const char* name : {"courtyard", "street", "islands", "dusty-room"}) {
        const Place place(name);
        const double inside = partInside(place, place.poses({.inside = true}, 16)),
                     around = partInside(place, place.poses({}, 16));
        std::printf("%-12s inside %.3f, around %.3f\n", name, inside, around);
        // Islands have no ground: some look over all of them, into fog that nothing bounds.
        EXPECT_GE(inside, place.scene.planes.empty() ? 0.88 : 0.9) << name;
        if (place.scene.name == "courtyard") {
            EXPECT_LE(around, 0.2);
        }
    }
}

TEST(Stand, EyesAreSideBySideAndCopiesAreTurned) {
    const Place place("courtyard");
    const std::vector<Pose> eyes = place.poses({.eyes_apart = 0.064f}, 2), turned = place.poses({.apart = 90}, 2);
    EXPECT_NEAR(glm::distance(eyes[0].position, eyes[1].position), 0.064, 1e-5);
    EXPECT_EQ(eyes[0].orientation, eyes[1].orientation);
    EXPECT_GT(glm::dot(eyes[1].position - eyes[0].position, eyes[0].orientation * glm::vec3(1, 0, 0)), 0.06f);
    EXPECT_EQ(turned[0].position, turned[1].position);
    const glm::vec3 ahead(0, 0, -1);
    EXPECT_NEAR(glm::dot((turned[0].orientation * ahead) * glm::vec3(1, 0, 1),
                         (turned[1].orientation * ahead) * glm::vec3(1, 0, 1)),
                0, 1e-5);
}

TEST(Stand, ViewersStandInOneWay) {
    const std::filesystem::path file = folder("stand") / "s.toml";
    std::ofstream(file) << "[[series]]\nname = \"a\"\nscenes = [\"cloud\"]\nstand = \"inside\"\napart = 5\n";
    try {
        loadSweep(file);
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find(":4: series[0].stand: viewers stand in more than one way"),
                  std::string::npos)
            << error.what();
    }
}

TEST(Stand, APlaceWithoutRoomIsRefused) {
    Scene scene;
    scene.name = "full";
    scene.boxes = {{{0, 0, 0}, {1, 1, 1}, 0, glm::vec3(0.5f)}};
    try {
        standInside(scene, {}, 1);
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_STREQ(error.what(), "full: stand = \"inside\": no room for 1 viewers");
    }
}

} // namespace
} // namespace brume::bench::stand_test
