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

// A scene of one point cloud, in files of its own. `header`: properties besides x, y, z; `body`: the points.
std::filesystem::path cloudScene(const std::string& header, const std::string& body, const std::string& medium = "") {
    const std::filesystem::path folder(testing::TempDir());
    std::ofstream(folder / "layout_test.ply")
        << "ply\nformat ascii 1.0\nelement vertex " << std::count(body.begin(), body.end(), '\n')
        << "\nproperty float x\nproperty float y\nproperty float z\n"
        << header << "end_header\n"
        << body;
    std::ofstream(folder / "layout_test.toml")
        << "[medium]\nlayout = 'file'\nfile = 'layout_test.ply'\nmultiplier = 10\n"
        << medium;
    return folder / "layout_test.toml";
}

const std::string kOwn = "property float sigma_t\nproperty float red\nproperty float green\nproperty float blue\n";

TEST(PointClouds, SlidersAreFactorsOfTheirOwnValues) {
    const Scene scene = loadScene(
        cloudScene(kOwn, "0 0 0 0.3 0.1 0.6 1\n1 0 0 7 1 0 0.7\n", "extinction = 7\nalbedo = [0.3, 0, 0.9]\n"));
    Simulation simulation(scene);
    const auto before = particlesOf(simulation);
    EXPECT_EQ(before[0].sigma_t, 0.3f) << "as loaded: the file's own bits";
    EXPECT_EQ(before[0].albedo, glm::vec3(0.1f, 0.6f, 1));
    const uint64_t hash_before = simulation.stateHash();

    give(simulation, {command(Set{{"medium.extinction", 3.5f}, {"medium.albedo", glm::vec3(0.9f, 0.5f, 0.45f)}})});
    const auto after = particlesOf(simulation);
    EXPECT_EQ(after[0].sigma_t, 0.15f);
    EXPECT_EQ(after[1].sigma_t, 3.5f);
    EXPECT_NEAR(after[0].albedo.x, 0.3f, 1e-6f);
    EXPECT_EQ(after[0].albedo.y, 0.6f) << "nothing is relative to a start of 0";
    EXPECT_EQ(after[0].albedo.z, 0.5f);
    EXPECT_EQ(after[1].albedo, glm::vec3(1, 0, 0.35f)) << "at most 1";
    EXPECT_NE(simulation.stateHash(), hash_before);

    give(simulation, {command(Restart{})});
    EXPECT_EQ(particlesOf(simulation)[0].sigma_t, before[0].sigma_t);
    EXPECT_EQ(particlesOf(simulation)[0].albedo, before[0].albedo);

    give(simulation, {command(Set{{"medium.extinction", 1e5f}})});
    EXPECT_LE(particlesOf(simulation)[1].sigma_t, 1e4f) << "as for a file: limits::kSigmaT";
}

TEST(PointClouds, ADarkStartLeavesTheirOwnExtinctions) {
    Simulation simulation(loadScene(cloudScene(kOwn, "0 0 0 0.3 0.1 0.6 1\n", "extinction = 0\n")));
    EXPECT_EQ(particlesOf(simulation)[0].sigma_t, 0.3f);
    give(simulation, {command(Set{{"medium.extinction", 3.0f}})});
    EXPECT_EQ(particlesOf(simulation)[0].sigma_t, 0.3f);
}

TEST(PointClouds, TheirColoursArePartOfTheState) {
    const uint64_t one = Simulation(loadScene(cloudScene(kOwn, "0 0 0 3 0.1 0.6 1\n"))).stateHash();
    EXPECT_NE(Simulation(loadScene(cloudScene(kOwn, "0 0 0 3 0.2 0.6 1\n"))).stateHash(), one);
    EXPECT_NE(Simulation(loadScene(cloudScene(kOwn, "0 0 0 4 0.1 0.6 1\n"))).stateHash(), one);
}

// 1000 points on a lattice; `step`: m.
std::string lattice(float step) {
    std::string body;
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 p = step * glm::vec3(i % 10, i / 10 % 10, i / 100);
        body += std::to_string(p.x) + ' ' + std::to_string(p.y) + ' ' + std::to_string(p.z) + '\n';
    }
    return body;
}

TEST(PointClouds, WithoutSizesTheirSpacingDecides) {
    for (const float step : {0.01f, 0.5f, 40.0f}) {
        const auto placed = particlesOf(Simulation(loadScene(cloudScene("", lattice(step), "falloff = 2\n"))));
        const float deviation = 0.1f * 2 * placed[0].scale;
        EXPECT_NEAR(deviation, 0.5f * std::sqrt(2.0f) * step, 0.01f * step) << "half the distance to the 8th neighbour";
        EXPECT_EQ(placed[999].scale, placed[0].scale);
    }
    const auto given = particlesOf(Simulation(loadScene(cloudScene("", lattice(0.5f), "scale = 6\n"))));
    EXPECT_EQ(given[0].scale, 6) << "what the scene says holds, be it the default";
    EXPECT_EQ(particlesOf(Simulation(loadScene(cloudScene("", "1 2 3\n"))))[0].scale, 6) << "no spacing: the default";
}

TEST(PointClouds, ARadiusIsThatOfABallThatSpreadsAsFar) {
    const auto placed = particlesOf(
        Simulation(loadScene(cloudScene("property float radius\n", "0 0 0 2\n1 0 0 0.5\n", "falloff = 2\n"))));
    const auto deviation = [](const gpu::Particle& p) { return 0.1f * 2 * p.scale; };
    EXPECT_NEAR(deviation(placed[0]), 2 / std::sqrt(5.0f), 1e-5f) << "mean of x^2 in a ball of radius r: r^2 / 5";
    EXPECT_NEAR(deviation(placed[1]), 0.5f / std::sqrt(5.0f), 1e-5f);
}

TEST(PointClouds, AnOpacityIsThatOfARayThroughTheCentre) {
    const auto placed = particlesOf(Simulation(loadScene(cloudScene(
        "property float scale\nproperty float opacity\n", "0 0 0 2 0.75\n1 0 0 4 0.75\n2 0 0 3 0\n3 0 0 3 1\n"))));
    const auto through = [](const gpu::Particle& p) { // of a Gaussian: peak * deviation * sqrt(2 pi)
        return 1 - std::exp(-p.sigma_t * 0.1f * 1.6f * p.scale * 2.5066283f);
    };
    EXPECT_NEAR(through(placed[0]), 0.75f, 1e-5f);
    EXPECT_NEAR(through(placed[1]), 0.75f, 1e-5f);
    EXPECT_EQ(placed[2].sigma_t, 0);
    EXPECT_NEAR(through(placed[3]), 1 - 1 / 512.0f, 1e-5f) << "1 within half a level of a picture of 8 bits";
}

} // namespace
} // namespace brume
