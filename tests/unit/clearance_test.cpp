// Particles have a width, which stays before walls.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.h"
#include "server/sim/obstacles.h"
#include "server/sim/simulation.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::clearance_test {
namespace {

constexpr float kDt = 1 / 60.0f;
constexpr float kClear = 0.352f; // m, 2.2 deviations of a particle of scale 1 and falloff 1.6

// One particle of scale 1 that a force moves, and solids stop.
struct One {
    glm::vec3 place, velocity{0}, force{0}; // m/s^2
};
One after(const Obstacles& obstacles, One one, int ticks, const Obstacles::Widths& widths = {.clearance = kClear}) {
    Columns columns(1);
    columns[Column::scale][0] = 1;
    for (int tick = 0; tick < ticks; ++tick) {
        one.velocity += kDt * one.force;
        one.place += kDt * one.velocity;
        for (int axis = 0; axis < 3; ++axis) {
            columns[Column(int(Column::x) + axis)][0] = one.place[axis];
            columns[Column(int(Column::vx) + axis)][0] = one.velocity[axis];
        }
        obstacles.stop(columns, {0, 1}, kDt, widths);
        for (int axis = 0; axis < 3; ++axis) {
            one.place[axis] = columns[Column(int(Column::x) + axis)][0];
            one.velocity[axis] = columns[Column(int(Column::vx) + axis)][0];
        }
    }
    return one;
}

Obstacles of(const Scene& scene) {
    Obstacles out(scene);
    out.follow(listsOf(scene), 1);
    return out;
}
Obstacles ofBoxes(const std::vector<Box>& boxes) {
    Scene scene;
    scene.boxes = boxes;
    return of(scene);
}

// Triangles of 0.25 m, from -3 to 3 in x and z, whose heights are those of a function.
std::vector<Triangle> sheet(const std::function<float(float, float)>& height) {
    std::vector<Triangle> out;
    const auto at = [&](int i, int j) {
        const float x = 0.25f * float(i), z = 0.25f * float(j);
        return glm::vec3(x, height(x, z), z);
    };
    for (int i = -12; i < 12; ++i)
        for (int j = -12; j < 12; ++j) {
            out.push_back({.corners = {at(i, j), at(i + 1, j), at(i, j + 1)}, .albedo = {}});
            out.push_back({.corners = {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, .albedo = {}});
        }
    return out;
}

TEST(Clearance, IsOfAGaussiansDeviationAndOfABallsRadius) {
    Medium medium{.falloff = 1.6f};
    EXPECT_NEAR(Obstacles::clearanceOf(medium), double(kClear), 1e-7);
    medium.model = kUnionMedium, medium.union_radius = 0.2f;
    EXPECT_EQ(Obstacles::clearanceOf(medium), double(0.2f));
    medium.model = kTetrahedraMedium;
    EXPECT_EQ(Obstacles::clearanceOf(medium), 0);
}

TEST(Clearance, WhoIsTooNearComesOffSlowly) {
    Scene corner, ball, mesh;
    corner.boxes = {{.centre = {0, -1, 0}, .size = {4, 2, 4}, .yaw = 0.3f}};
    ball.spheres = {{.centre = {0, -1, 0}, .radius = 1}};
    mesh.triangles = sheet([](float, float) { return 0.0f; });
    for (const Obstacles& floor : {of(corner), of(ball), of(mesh)}) {
        const One first = after(floor, {.place = {0, 0.01f, 0}}, 1);
        EXPECT_GT(first.place.y, 0.01f);
        EXPECT_LT(first.place.y, 0.05f) << "no jump";
        const One last = after(floor, {.place = {0, 0.01f, 0}}, 300);
        EXPECT_NEAR(last.place.y, kClear, 1e-3f);
        EXPECT_NEAR(glm::length(glm::vec2(last.place.x, last.place.z)), 0, 1e-3f) << "straight off";
        EXPECT_EQ(last.velocity, glm::vec3(0));
        const One pressed = after(floor, {.place = {0, 0.5f, 0}, .force = {0, -3, 0}}, 600);
        EXPECT_NEAR(pressed.place.y, kClear, 0.01f);
        const One sliding = after(floor, {.place = {-1.5f, kClear, 0}, .velocity = {2, 0, 0}}, 60);
        EXPECT_GT(sliding.velocity.x, 1.9f) << "a wall does not brake who moves along it";
    }
}

TEST(Clearance, IsOfAnEllipsoidsWidthAcrossTheWall) {
    const Obstacles floor = ofBoxes({{.centre = {0, -1, 0}, .size = {4, 2, 4}}});
    const gpu::EllipsoidAxes flat{{1, 0, 0}, {0, 0.25f, 0}, {0, 0, 1}}, tall{{0, 1, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}};
    const auto height = [&](const gpu::EllipsoidAxes& axes) {
        return after(floor, {.place = {0, 0.01f, 0}}, 300, {.clearance = kClear, .axes = {&axes, 1}}).place.y;
    };
    EXPECT_NEAR(height(flat), 0.25f * kClear, 1e-3f);
    EXPECT_NEAR(height(tall), kClear, 1e-3f);
}

TEST(Clearance, IsNotOfTheGround) {
    Scene scene;
    scene.planes.push_back({.height = 0});
    const One lying = after(of(scene), {.place = {0, 0.05f, 0}, .force = {0, -1, 0}}, 120);
    EXPECT_GT(lying.place.y, 0);
    EXPECT_LT(lying.place.y, 0.0011f);
}

// Two slabs 0.3 m apart; two deviations on both sides would take 0.64.
TEST(Clearance, ANarrowChannelIsPassedAlongItsMiddle) {
    const Obstacles channel =
        ofBoxes({{.centre = {0, 0.65f, 0}, .size = {8, 1, 4}}, {.centre = {0, -0.65f, 0}, .size = {8, 1, 4}}});
    One one = after(channel, {.place = {-2, 0.12f, 0}, .velocity = {0.5f, 0, 0}}, 300);
    EXPECT_NEAR(one.place.y, 0, 1e-3f);
    EXPECT_NEAR(one.place.x, 0.5f, 1e-3f);
    for (int tick = 0; tick < 60; ++tick) {
        const One next = after(channel, one, 1);
        EXPECT_NEAR(next.place.y, one.place.y, 1e-4f) << "it rests there";
        EXPECT_EQ(next.velocity.x, 0.5f);
        one = next;
    }
}

// A hole of 0.3 m in a wall, and something that is driven to it.
TEST(Clearance, ANarrowOpeningIsPassed) {
    const Obstacles wall = ofBoxes({{.centre = {0, 1.15f, 0}, .size = {0.05f, 2, 4}},
                                    {.centre = {0, -1.15f, 0}, .size = {0.05f, 2, 4}},
                                    {.centre = {0, 0, 1.15f}, .size = {0.05f, 0.3f, 2}},
                                    {.centre = {0, 0, -1.15f}, .size = {0.05f, 0.3f, 2}}});
    for (const float off : {0.0f, 0.03f, 0.1f}) {
        const One through = after(wall, {.place = {-1, off, -off}, .velocity = {0.3f, 0, 0}}, 400);
        EXPECT_GT(through.place.x, 0.95f) << off;
        EXPECT_EQ(through.velocity.x, 0.3f) << off;
        EXPECT_LT(std::abs(through.place.y), 0.1f) << off;
    }
    const One beside = after(wall, {.place = {-1, 0.6f, 0.6f}, .velocity = {0.3f, 0, 0}}, 600);
    EXPECT_NEAR(beside.place.x, -0.025f - kClear, 0.01f) << "the wall itself holds";
}

// In a room with acute edges that is too small in all directions: nothing comes out, nor moves by more than a few
// millimetres in a tick.
TEST(Clearance, ACavityHoldsWhatIsInIt) {
    Scene scene; // a tetrahedron
    const glm::vec3 a(0.25f, 0.25f, 0.25f), b(0.25f, -0.25f, -0.25f), c(-0.25f, 0.25f, -0.25f),
        d(-0.25f, -0.25f, 0.25f);
    for (const auto& [p, q, r] : {std::array{a, b, c}, {a, c, d}, {a, d, b}, {b, d, c}})
        scene.triangles.push_back({.corners = {p, q, r}, .albedo = {}});
    const Obstacles cavity = of(scene);
    Random random(1, 1);
    for (int i = 0; i < 100; ++i) {
        One one = after(cavity, {.velocity = 3.0f * random.inBall(), .force = 3.0f * random.inBall()}, 300);
        one.force = glm::vec3(0);
        one = after(cavity, one, 60);
        for (int tick = 0; tick < 60; ++tick) {
            const One next = after(cavity, one, 1);
            const glm::vec3 p = next.place;
            ASSERT_LT(std::max({-p.x - p.y - p.z, p.x + p.y - p.z, p.x - p.y + p.z, p.y + p.z - p.x}), 0.25f);
            ASSERT_LT(glm::distance(p, one.place), 0.006f);
            one = next;
        }
    }
}

// Of the particles within three deviations before a wall: the part of their mass that is behind it, by the closed form
// of a plane. `off`: a particle's distance from a wall's face, where it is before one.
template <class Distance>
double partBehind(const Scene& scene, Distance off) {
    Simulation simulation(scene);
    double behind = 0, all = 0;
    int inside = 0;
    for (int tick = 0; tick < 3600; ++tick) {
        simulation.step({});
        for (const gpu::Particle& p : particlesOf(simulation)) {
            const std::optional<double> distance = off(p.centre);
            if (!distance) continue;
            inside += *distance < 0;
            const double deviation = 0.1 * double(p.scale) * double(scene.medium.falloff),
                         mass = double(p.sigma_t) * deviation * deviation * deviation,
                         deviations = *distance / deviation;
            if (tick < 600 || deviations > 3) continue;
            behind += 0.5 * mass * std::erfc(deviations / std::sqrt(2));
            all += mass;
        }
    }
    EXPECT_EQ(inside, 0);
    EXPECT_GT(all, 0);
    return behind / all;
}

// Smoke that rises for 8 s, to what is 2.5 m above.
Scene under() {
    Scene scene = plumeScene();
    scene.medium.count = 3000;
    scene.medium.emitter = {.radius = 0.6f, .rate = 250, .life = 8, .buoyancy = 2, .turbulence = 1.5f};
    scene.simulation.collide = true;
    return scene;
}

TEST(Clearance, SmokeUnderACeilingDoesNotShowAboveIt) {
    Scene scene = under();
    scene.boxes = {{.centre = {0, 2.5f, 0}, .size = {5, 0.05f, 4}}};
    EXPECT_LT(partBehind(scene,
                         [](glm::vec3 p) -> std::optional<double> {
                             if (std::abs(p.x) > 2.5f || std::abs(p.z) > 2 || p.y > 2.5f) return {};
                             return 2.475 - double(p.y);
                         }),
              0.03);
}

TEST(Clearance, SmokeAgainstAThinWallDoesNotShowBehindIt) {
    Scene scene = under();
    scene.medium.emitter.wind = {2, 0, 0};
    scene.boxes = {{.centre = {2, 2, 0}, .size = {0.02f, 6, 8}}};
    EXPECT_LT(partBehind(scene,
                         [](glm::vec3 p) -> std::optional<double> {
                             if (std::abs(p.y - 2) > 3 || std::abs(p.z) > 4 || p.x > 2) return {};
                             return 1.99 - double(p.x);
                         }),
              0.03);
}

TEST(Clearance, SmokeUnderABallIsBesideIt) {
    Scene scene = under();
    scene.spheres = {{.centre = {0, 3, 0}, .radius = 1.2f}};
    EXPECT_LT(partBehind(scene,
                         [](glm::vec3 p) -> std::optional<double> {
                             return double(glm::distance(p, glm::vec3(0, 3, 0))) - double(1.2f);
                         }),
              0.03);
}

TEST(Clearance, SmokeUnderAMeshDoesNotShowAboveIt) {
    Scene scene = under();
    scene.triangles = sheet([](float, float) { return 2.5f; });
    EXPECT_LT(partBehind(scene,
                         [](glm::vec3 p) -> std::optional<double> {
                             if (std::abs(p.x) > 3 || std::abs(p.z) > 3 || p.y > 2.6f) return {};
                             return 2.5 - double(p.y);
                         }),
              0.03);
}

// A simulation that goes on from a saved state has none of the widths of those that died before.
TEST(Clearance, GoesOnFromASavedStateToTheSameBits) {
    Scene scene = under();
    scene.boxes = {{.centre = {0, 1, 0}, .size = {5, 0.05f, 4}}};
    Simulation first(scene), second(scene);
    for (int tick = 0; tick < 200; ++tick) first.step({});
    std::vector<std::byte> saved;
    first.save(saved);
    second.load(saved);
    for (int tick = 0; tick < 100; ++tick) {
        first.step({});
        second.step({});
        ASSERT_EQ(first.stateHash(), second.stateHash()) << tick;
    }
}

} // namespace
} // namespace brume::clearance_test
