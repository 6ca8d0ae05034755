// Particles and what they cannot pass.
#include "server/sim/obstacles.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/sim/simulation.h"
#include "tests/unit/gltf_file.h"
#include "tests/unit/scene_file.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::obstacles_test {
namespace {

constexpr float kDt = 1 / 60.0f;

// One particle that moved by its velocity in the last tick.
struct One {
    glm::vec3 place, velocity;
};
One stopped(const Obstacles& obstacles, const One& one, const Obstacles::Widths& widths = {}) {
    Columns columns(1);
    columns[Column::scale][0] = 1;
    for (int axis = 0; axis < 3; ++axis) {
        columns[Column(int(Column::x) + axis)][0] = one.place[axis];
        columns[Column(int(Column::vx) + axis)][0] = one.velocity[axis];
    }
    obstacles.stop(columns, {0, 1}, kDt, widths);
    One out{};
    for (int axis = 0; axis < 3; ++axis) {
        out.place[axis] = columns[Column(int(Column::x) + axis)][0];
        out.velocity[axis] = columns[Column(int(Column::vx) + axis)][0];
    }
    return out;
}

Obstacles of(const Scene& scene) {
    Obstacles out(scene);
    out.follow(listsOf(scene), 1);
    return out;
}
Obstacles ofBox(glm::vec3 centre, glm::vec3 size, float yaw = 0) {
    Scene scene;
    scene.boxes.push_back({.centre = centre, .size = size, .yaw = yaw});
    return of(scene);
}
Obstacles ofSquare(float height) { // two triangles that share an edge
    Scene scene;
    const glm::vec3 a(-1, height, -1), b(1, height, -1), c(1, height, 1), d(-1, height, 1);
    scene.triangles = {{.corners = {a, b, c}, .albedo = {}}, {.corners = {a, c, d}, .albedo = {}}};
    return of(scene);
}

TEST(Obstacles, NothingIsFastEnoughToPassAThinWall) {
    for (const Obstacles& wall : {ofBox({0, 0, 0}, {2, 0.01f, 2}), ofSquare(0)})
        for (const float side : {1.0f, -1.0f}) {
            const One after = stopped(wall, {{0.2f, -side * 0.9f, 0.1f}, {0, -side * 100, 0}}); // 1.67 m in a tick
            EXPECT_GT(side * after.place.y, 0) << "it stays on its side";
            EXPECT_LT(side * after.place.y, 0.01f) << "before the wall";
            EXPECT_EQ(after.velocity.y, 0);
        }
    const One beside = stopped(ofSquare(0), {{1.5f, -0.5f, 0}, {0, -60, 0}});
    EXPECT_EQ(beside.place, glm::vec3(1.5f, -0.5f, 0)) << "who meets nothing is left as it is";
    EXPECT_EQ(beside.velocity.y, -60);
}

TEST(Obstacles, NothingPassesBetweenTwoTriangles) {
    const Obstacles wall = ofSquare(0);
    for (int i = -99; i < 100; ++i) { // all along the edge that both have
        const float x = 0.01f * float(i);
        EXPECT_GT(stopped(wall, {{x, -0.5f, x}, {0, -60, 0}}).place.y, 0) << x;
    }
}

TEST(Obstacles, WhatMeetsSomethingSlidesAlongIt) {
    const One after = stopped(ofSquare(0), {{0.3f, -0.1f, 0}, {30, -12, 0}}); // from (-0.2, 0.1, 0)
    EXPECT_EQ(after.velocity, glm::vec3(30, 0, 0));
    EXPECT_NEAR(after.place.x, 0.3f, 1e-5f) << "the way along the wall is walked to its end";
    EXPECT_NEAR(after.place.y, Obstacles::gapAt(glm::dvec3(0)), 1e-6f);
    // Into a corner: nothing is left.
    Scene corner;
    corner.planes.push_back({.height = 0});
    corner.boxes.push_back({.centre = {2, 1, 0}, .size = {2, 2, 8}}); // its side is at x = 1
    const One caught = stopped(of(corner), {{1.3f, -0.2f, 0}, {30, -30, 0}});
    EXPECT_LT(caught.place.x, 1);
    EXPECT_GT(caught.place.y, 0);
    EXPECT_EQ(caught.velocity, glm::vec3(0));
}

TEST(Obstacles, TurnedBoxesAndSpheresAreWhereTheyAreSeen) {
    // A quarter of a turn about the vertical: what was along x is along z.
    const Obstacles turned = ofBox({0, 0, 0}, {4, 1, 0.2f}, 1.5707964f);
    EXPECT_GT(stopped(turned, {{-0.5f, 0, 1.5f}, {-60, 0, 0}}).place.x, 0.1f) << "from (0.5, 0, 1.5)";
    EXPECT_EQ(stopped(turned, {{1.5f, 0, -0.5f}, {0, 0, -60}}).place.z, -0.5f) << "nothing is there";
    Scene scene;
    scene.spheres.push_back({.centre = {0, 5, 0}, .radius = 1});
    const Obstacles ball = of(scene);
    const One after = stopped(ball, {{0, 5, 0.3f}, {0, 0, 60}}); // from z = -0.7: it was inside
    EXPECT_GT(glm::distance(after.place, glm::vec3(0, 5, 0)), 1);
    EXPECT_GT(glm::distance(stopped(ball, {{0, 5.5f, 0}, {0, -60, 0}}).place, glm::vec3(0, 5, 0)), 1);
}

TEST(Obstacles, WhoIsInsideComesOutTheShortestWay) {
    const One after = stopped(ofBox({0, 0, 0}, {2, 2, 2}), {{0.9f, 0.1f, -0.2f}, {0, 0, 0}});
    EXPECT_NEAR(after.place.x, 1, 0.01f);
    EXPECT_GT(after.place.x, 1);
    EXPECT_EQ(after.place.y, 0.1f);
    EXPECT_EQ(stopped(ofBox({0, 0, 0}, {2, 2, 2}), {{0, 0, 0}, {0, 0, 0}}).place.x, 0) << "one way only";
}

// A hall of every kind of thing, and an emitter below it.
std::filesystem::path hall(bool collides) {
    test::GltfFile mesh; // a triangle (0, 0, 0), (1, 0, 0), (0, 1, 0)
    std::ofstream(std::filesystem::path(testing::TempDir()) / "obstacles.glb", std::ios::binary) << mesh.glb();
    return test::written(fmt::format(R"(
[medium]
layout = "emitter"
count = 3000
[medium.emitter]
position = [0, 0.3, 0]
radius = 1
rate = 300
life = 8
turbulence = 2
[simulation]
collide = {}
[[plane]]
height = 0
[[box]]
centre = [0, 3, 0]
size = [3, 0.05, 3]
yaw = 0.5
[[box]]
centre = [2, 2, 0]
size = [0.1, 4, 4]
[[sphere]]
centre = [-1.5, 2, 0.5]
radius = 1
[[mesh]]
file = "obstacles.glb"
position = [-1, 4.5, -1]
scale = 4
)",
                                     collides));
}

TEST(Obstacles, NobodyIsInsideAfterAMinute) {
    const Scene scene = loadScene(hall(true));
    Simulation simulation(scene), free(loadScene(hall(false)));
    const auto inside = [&](glm::vec3 p) {
        const glm::vec3 off = p - glm::vec3(0, 3, 0);
        const glm::vec3 at(std::cos(0.5f) * off.x - std::sin(0.5f) * off.z, off.y,
                           std::sin(0.5f) * off.x + std::cos(0.5f) * off.z);
        return p.y < 0 || glm::all(glm::lessThan(glm::abs(at), glm::vec3(1.5f, 0.025f, 1.5f))) ||
               glm::all(glm::lessThan(glm::abs(p - glm::vec3(2, 2, 0)), glm::vec3(0.05f, 2, 2))) ||
               glm::distance(p, glm::vec3(-1.5f, 2, 0.5f)) < 1;
    };
    size_t inside_free = 0;
    for (int tick = 0; tick < 3600; ++tick) {
        simulation.step({});
        free.step({});
        for (const gpu::Particle& p : particlesOf(simulation)) ASSERT_FALSE(inside(p.centre)) << tick;
        for (const gpu::Particle& p : particlesOf(free)) inside_free += inside(p.centre);
    }
    EXPECT_GT(inside_free, 1000u) << "the smoke goes there, where nothing stops it";
    EXPECT_NE(simulation.stateHash(), free.stateHash());
    Simulation again(scene);
    for (int tick = 0; tick < 3600; ++tick) again.step({});
    EXPECT_EQ(again.stateHash(), simulation.stateHash());
}

TEST(Obstacles, WhatIsMovedWhileTheServerRunsIsFollowed) {
    const Scene scene = loadScene(hall(true));
    Simulation simulation(scene);
    for (int tick = 0; tick < 120; ++tick) simulation.step({});
    give(simulation, {command(Set{{"sphere[0].centre", glm::vec3(0, 1.2f, 0)}})});
    for (const gpu::Particle& p : particlesOf(simulation))
        EXPECT_GE(glm::distance(p.centre, glm::vec3(0, 1.2f, 0)), 1.0f) << "pushed aside in the tick that moved it";
}

} // namespace
} // namespace brume::obstacles_test
