// Layouts: where the particles of each stand at the start.
#include "server/sim/layout.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/simulation_scenes.h"

namespace brume {
namespace {

TEST(Layouts, CubeFillsItsCube) {
    const Placement placed = place(cubeScene(20000).medium);
    glm::dvec3 sum(0), squares(0);
    for (const glm::vec3& p : placed.position) {
        for (int axis = 0; axis < 3; ++axis) ASSERT_LE(std::abs(p[axis]), 5);
        sum += glm::dvec3(p);
        squares += glm::dvec3(p * p);
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(sum[axis] / 20000, 0, 0.06);
        EXPECT_NEAR(squares[axis] / 20000, 100.0 / 12, 0.2); // a uniform side of 10
    }
    for (const float m : placed.multiplier) ASSERT_TRUE(m >= 5 && m < 10);
}

TEST(Layouts, TubesCrossWithAGap) {
    Medium medium = cubeScene(2000).medium;
    medium.layout = Layout::tubes;
    const Placement placed = place(medium);
    for (size_t i = 0; i < placed.position.size(); ++i) {
        const glm::vec3 p = placed.position[i];
        const float across = i % 2 == 0 ? p.x : p.z, along = i % 2 == 0 ? p.z : p.x;
        EXPECT_EQ(p.y > 0, i % 2 == 0);
        EXPECT_LE(std::hypot(across, std::abs(p.y) - 1.6f), 1.2001f);
        EXPECT_LE(std::abs(along), 5);
    }
}

TEST(Layouts, CumulusStandsOnItsBaseWithItsDetailOutside) {
    Medium medium = cubeScene(8000).medium;
    medium.layout = Layout::cumulus;
    medium.extent = 20;
    medium.scale = {0.5f, 6};
    medium.centre = {0, 30, 0};
    const Placement placed = place(medium);
    ASSERT_EQ(placed.position.size(), 8000u);
    float lo = 1e9f, hi = -1e9f, top = 0;
    size_t low = 0, small = 0;
    for (size_t i = 0; i < 8000; ++i) {
        const glm::vec3 p = placed.position[i] - medium.centre;
        ASSERT_GE(p.y, 0);
        lo = std::min(lo, p.x);
        hi = std::max(hi, p.x);
        top = std::max(top, p.y);
        low += p.y < 1;
        small += placed.scale[i] < 1;
        ASSERT_TRUE(placed.scale[i] >= 0.5f && placed.scale[i] <= 6);
    }
    EXPECT_NEAR(hi - lo, 20, 0.5);
    EXPECT_GT(top, 6);       // it towers
    EXPECT_GT(low, 400u);    // on a base
    EXPECT_GT(small, 4000u); // small particles are many, large ones few
    EXPECT_GT(8000 - small, 100u);
}

TEST(Layouts, AFileBringsItsOwnParticles) {
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "simulation_test.ply";
    const std::string xyz =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
    std::ofstream(file) << xyz << "end_header\n1 2 3\n4 5 6\n";
    Scene scene = cubeScene();
    scene.medium.layout = Layout::file;
    scene.medium.file = file;
    scene.medium.centre = {10, 0, 0};
    const Set change{{"medium.extinction", 30.0f}, {"medium.albedo", glm::vec3(0.5f)}};
    {
        Simulation simulation(scene);
        const auto before = particlesOf(simulation);
        ASSERT_EQ(before.size(), 2u);
        EXPECT_EQ(simulation.now().medium.count, 2u);
        EXPECT_EQ(before[1].centre, glm::vec3(14, 5, 6));
        EXPECT_EQ(before[0].scale, 6);
        give(simulation, {command(change)});
        EXPECT_NEAR(particlesOf(simulation)[0].sigma_t, 2 * before[0].sigma_t, 1e-6f);
        EXPECT_EQ(particlesOf(simulation)[0].albedo, glm::vec3(0.5f));
    }
    std::ofstream(file) << xyz
                        << "property float scale\nproperty float sigma_t\nproperty uchar red\nproperty uchar green\n"
                        << "property uchar blue\nend_header\n1 2 3 0.5 7 255 0 0\n4 5 6 0.25 8 0 255 0\n";
    Simulation simulation(scene);
    give(simulation, {command(change)});
    const auto own = particlesOf(simulation);
    EXPECT_EQ(own[0].scale, 0.5f);
    EXPECT_EQ(own[0].sigma_t, 14) << "twice the scene's extinction: twice the file's";
    EXPECT_EQ(own[1].sigma_t, 16);
    EXPECT_EQ(own[1].albedo, glm::vec3(0, 0.5f / 0.9f, 0));
    EXPECT_EQ(simulation.bounds().max_sigma_t, 16);

    scene.medium.file = "no/such.ply";
    EXPECT_THROW(Simulation{scene}, SceneError);
}

} // namespace
} // namespace brume
