// Layout `file`: a user's own points, and what the user is told about them.
#include "server/sim/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "common/camera.h"
#include "common/tetrahedra.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::point_cloud_test {
namespace {

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

// One after another, each with a line break.
std::string told(const std::filesystem::path& file) {
    const Scene scene = loadScene(file);
    const Simulation simulation(scene);
    std::string lines = pointCloudLine(scene, simulation) + '\n';
    for (const std::string& warning : pointCloudWarnings(scene, simulation)) lines += warning + '\n';
    return lines;
}

void expectIn(const std::string& text, const std::string& what) {
    EXPECT_NE(text.find(what), text.npos) << what << "\nis not in: " << text;
}

TEST(PointClouds, OneLineSaysWhatCame) {
    const std::string bare = told(cloudScene("property float nx\nproperty uchar alpha\n", "-1 0 2 1 9\n3 4 2.5 1 9\n"));
    expectIn(bare, "layout_test.ply': 2 points in [-1, 0, 2] to [3, 4, 2.5] m; scale ");
    expectIn(bare, "(from the spacing of the points, as no size came; medium.scale replaces it)");
    expectIn(bare,
             "; extinction 0.8322 1/m (for an optical depth of 3, as none came; medium.extinction replaces "
             "it; as medium.multiplier = 1 with medium.extinction = 8322); no colours; ignored properties: nx, alpha; "
             "optical depth about 3");
    EXPECT_EQ(std::count(bare.begin(), bare.end(), '\n'), 1) << bare;

    const std::string all = told(cloudScene("property float scale\n" + kOwn, "0 0 0 2 0.3 .1 .6 1\n1 0 0 3 7 1 0 1\n"));
    expectIn(all,
             "; scale 2 to 3 m (the file's scale); extinction 0.3 to 7 1/m (the file's sigma_t); with colours; every");

    const std::string other = told(cloudScene("property float radius\nproperty float opacity\n", "0 0 0 2 0.5\n"));
    expectIn(other, " m (from the file's radius); extinction ");
    expectIn(other, " 1/m (from the file's opacity); no colours;");

    expectIn(told(cloudScene("", "0 0 0\n", "scale = [2, 2]\n")), "scale 2 m (medium.scale)");
}

TEST(PointClouds, AnExtinctionThatTheSceneGivesIsTaken) {
    expectIn(told(cloudScene("", "-1 0 2\n3 4 2.5\n", "extinction = 20\n")),
             "extinction 0.02 1/m (medium.extinction, medium.multiplier)");
}

// Whatever the unit of a file, its cloud is seen.
TEST(PointClouds, ASceneWithoutACameraHasOneThatSeesAll) {
    for (const char* size : {"0.01", "1", "300"}) {
        const std::string far = std::string("-") + size;
        const float scale = 0.1f * std::stof(size);
        std::string points = far + " 0 0\n";
        points.append(size).append(" 0 0\n0 ").append(size).append(" 0\n");
        Scene scene = loadScene(cloudScene("", points, fmt::format("scale = [{0}, {0}]\n", scale)));
        placeCamera(scene);
        const float distance = glm::distance(scene.camera.position, scene.camera.target);
        EXPECT_GT(distance, std::stof(size)) << size;
        const Simulation simulation(scene);
        for (const std::string& warning : pointCloudWarnings(scene, simulation)) // the smallest may be thin
            EXPECT_NE(warning.find("nearly transparent"), warning.npos) << warning;
        // The points take nearly all of a picture's width.
        const Pose pose = lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y);
        const Frustum frustum = frustumOf(pose, 4, 3);
        float part = 0;
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        for (const gpu::Particle& p : particles) {
            const glm::vec3 at = glm::mat3_cast(glm::conjugate(pose.orientation)) * (p.centre - scene.camera.position);
            part = std::max({part, std::abs(at.x / at.z) / frustum.right, std::abs(at.y / at.z) / frustum.up});
        }
        EXPECT_GT(part, 0.75) << size;
        EXPECT_LT(part, 0.9) << size;
    }
    Scene own = loadScene(cloudScene("", "0 0 0\n1 0 0\n", "[camera]\nposition = [0, 3, 9]\n"));
    placeCamera(own);
    EXPECT_EQ(own.camera.position, glm::vec3(0, 3, 9));
}

TEST(PointClouds, TheLineSaysHowDenseTheyAre) {
    // Along any axis a single particle's depth is sigma_t s sqrt(2 pi); its mean over a square of 4 s is smaller.
    const std::string header = "property float scale\nproperty float sigma_t\n";
    expectIn(told(cloudScene(header, "0 0 0 1 10\n", "falloff = 1\n")), "optical depth about 0.98\n");
    expectIn(told(cloudScene(header, "0 0 0 1 .1\n", "falloff = 1\n")),
             "an optical depth of 0.0098 is nearly transparent: medium.exti");
}

TEST(PointClouds, AFileOfGaussianSplattingIsReadAsOne) {
    const std::string header = "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n"
                               "property float scale_0\nproperty float opacity\n";
    const auto file = cloudScene(header, "0 0 0 0 0 0 -1 0.5\n1 0 0 0 0 0 -1 -1.5\n");
    expectIn(told(file), "2 points in [0, 0, 0] to [1, 0, 0] m; scale 2.299 m (from the splats' scale_0 to scale_2)");
    expectIn(told(file), "Gaussian splatting: splats are balls");
    const gpu::Particle p = particlesOf(Simulation(loadScene(file)))[0];
    const double through = double(p.sigma_t) * 0.16 * double(p.scale) * 2.5066282746;
    EXPECT_NEAR(1 - std::exp(-through), 1 / (1 + std::exp(-0.5)), 1e-5) << "opacity of a ray through its centre";
}

TEST(PointClouds, UnitAxisAndOriginAreTheScenes) {
    const std::string far = "700000 5300000 400\n700001 5300000 400\n700000 5300002 400\n700000 5300000 403\n";
    const auto file = cloudScene("", far, "up = 'z'\n");
    std::ofstream(file, std::ios::app) << "";
    const std::string text = [&] {
        std::ifstream in(file);
        return std::string(std::istreambuf_iterator<char>(in), {});
    }();
    std::ofstream(file) << "origin = 'auto'\n" << text;
    const Scene scene = loadScene(file);
    EXPECT_LT(glm::distance(scene.origin, glm::dvec3(700000, 401, -5300001)), 3) << "turned, too";
    const std::string lines = told(file);
    expectIn(lines, "4 points in [700000, 400, -5300002] to [700001, 403, -5300000] m; scale ");
    const auto millimetres = particlesOf(Simulation(loadScene(cloudScene("", "0 0 0\n1000 0 0\n", "unit = 'mm'\n"))));
    EXPECT_NEAR(millimetres[1].centre.x, 1, 1e-6f);
    EXPECT_THROW(loadScene(cloudScene("", "0 0 0\n", "unit = 'mile'\n")), SceneError);
    EXPECT_THROW(loadScene(cloudScene("", "0 0 0\n", "up = 'w'\n")), SceneError);
}

TEST(PointClouds, ACloudThatIsTooSmallToBeNearToSaysTheUnit) {
    expectIn(told(cloudScene("", "0 0 0\n4e-6 0 0\n")), "smaller than a viewer can be near to: medium.unit = 2e+05");
}

TEST(PointClouds, MorePointsThanASceneMayHaveAreMerged) {
    constexpr uint32_t kMany = 1'200'000;
    std::ofstream out(std::filesystem::path(testing::TempDir()) / "layout_many.ply", std::ios::binary);
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << kMany
        << "\nproperty float x\nproperty float y\nproperty float z\nproperty float scale\nproperty float sigma_t\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    double mass = 0;
    for (uint32_t i = 0; i < kMany; ++i) {
        const uint32_t y = i / 100 % 100, z = i / 10000;
        const float row[5]{float(i % 100), float(y), float(z), 1, float(i % 7 + 1)};
        out.write(reinterpret_cast<const char*>(row), sizeof row).write("\xff\x33\0", 3);
        mass += i % 7 + 1;
    }
    out.close();
    std::ofstream(std::filesystem::path(testing::TempDir()) / "layout_many.toml")
        << "[medium]\nlayout = 'file'\nfile = 'layout_many.ply'\n";
    const Scene scene = loadScene(std::filesystem::path(testing::TempDir()) / "layout_many.toml");
    const Simulation simulation(scene);
    const auto particles = particlesOf(simulation);
    EXPECT_LE(particles.size(), 1'000'000u);
    EXPECT_GT(particles.size(), 100'000u);
    double kept = 0;
    for (const gpu::Particle& p : particles) kept += double(p.sigma_t) * std::pow(double(p.scale), 3);
    EXPECT_NEAR(kept / mass, 1, 1e-5) << "the integral of the extinction";
    EXPECT_NEAR(particles[0].albedo.y, 0.2f, 1e-6f);
    ASSERT_EQ(simulation.pointCloud()->notes.size(), 1u);
    expectIn(simulation.pointCloud()->notes[0], "1200000 points are merged to ");
}

// Four corners of a cube with edges of 2 m, and the middle tetrahedron of its five. `medium`: rest of the scene.
std::filesystem::path tetrahedraScene(const std::string& medium = "") {
    const std::filesystem::path folder(testing::TempDir());
    std::ofstream(folder / "tetrahedra_test.ply")
        << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
           "property float scale\n"
        << kOwn
        << "element tetrahedron 1\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0 9 0 .1 .2 .3\n2 2 0 9 0.5 .4 .5 .6\n2 0 2 9 1 .7 .8 .9\n0 2 2 9 4.5 1 1 1\n4 0 2 1 3\n";
    std::ofstream(folder / "tetrahedra_test.toml")
        << "[medium]\nmodel = 'tetrahedra'\nlayout = 'file'\nfile = 'tetrahedra_test.ply'\n"
        << medium;
    return folder / "tetrahedra_test.toml";
}

TEST(Tetrahedra, ParticlesAreTheFilesPointsInItsOrder) {
    const Scene scene = loadScene(tetrahedraScene("centre = [1, 0, 0]\n"));
    ASSERT_TRUE(scene.tetrahedra);
    EXPECT_EQ(scene.tetrahedra->corners, std::vector<glm::uvec4>{glm::uvec4(0, 2, 1, 3)}) << "turned: a volume > 0";
    const auto placed = particlesOf(Simulation(scene));
    ASSERT_EQ(placed.size(), 4u);
    EXPECT_EQ(placed[0].centre, glm::vec3(1, 0, 0));
    EXPECT_EQ(placed[3].centre, glm::vec3(1, 2, 2));
    EXPECT_EQ(placed[0].sigma_t, 0);
    EXPECT_EQ(placed[3].sigma_t, 4.5f);
    EXPECT_EQ(placed[1].albedo, glm::vec3(0.4f, 0.5f, 0.6f));
    EXPECT_FALSE(loadScene(cloudScene(kOwn, "0 0 0 1 1 1 1\n")).tetrahedra);
    const double deviation = 0.1 * double(placed[0].scale * scene.medium.falloff), volume = 8.0 / 3;
    EXPECT_NEAR(std::pow(std::sqrt(2 * std::numbers::pi) * deviation, 3), volume / 4, 1e-5) << "as much optical mass";
}

TEST(Tetrahedra, OneLineSaysWhatCame) {
    // A third of the cube's 8 m^3, times a mean extinction of 1.5 1/m, over a face of 4 m^2.
    const std::string lines = told(tetrahedraScene());
    expectIn(lines, "tetrahedra_test.ply': 1 tetrahedron of 4 points in [0, 0, 0] to [2, 2, 2] m; extinction 0 to 4.5 "
                    "1/m (the file's sigma_t); with colours; ignored properties: scale; optical depth about 1\n");
    expectIn(told(tetrahedraScene("centre = [0, 0, 40]\n[camera]\nposition = [0, 0, 26]\ntarget = [0, 0, 0]\n")),
             "sees none of the 4 points");
    const std::string within = "[camera]\nposition = [1, 1, 1]\ntarget = [1, 1, 0.99]\nfov_y = 0.1\n";
    EXPECT_EQ(told(tetrahedraScene(within)).find("sees none"), std::string::npos) << "it looks past all corners";
}

TEST(Tetrahedra, APointThatNoneHasIsLeftOutAndTold) {
    const std::filesystem::path folder = testing::TempDir();
    std::ofstream(folder / "unused_test.ply")
        << "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
           "property float sigma_t\nelement tetrahedron 1\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0 1\n9000 0 0 1\n2 0 0 1\n0 2 0 1\n0 0 2 1\n4 0 2 3 4\n";
    std::ofstream(folder / "unused_test.toml")
        << "[medium]\nmodel = 'tetrahedra'\nlayout = 'file'\nfile = 'unused_test.ply'\n";
    Scene scene = loadScene(folder / "unused_test.toml");
    EXPECT_EQ(scene.tetrahedra->points, 4u);
    EXPECT_EQ(Simulation(scene).bounds().hi, glm::vec3(2));
    placeCamera(scene);
    EXPECT_EQ(scene.camera.target, glm::vec3(1));
    const std::string lines = told(folder / "unused_test.toml");
    expectIn(lines, "1 tetrahedron of 4 points in [0, 0, 0] to [2, 2, 2] m; ");
    expectIn(lines, "dropped 1 of 5 points; the first, vertex 1: no tetrahedron has it\n");
}

TEST(Tetrahedra, WhatIsNotDrawnWithThemIsRefused) {
    for (const auto& [rest, says] : {std::pair("[[fog]]\n", "fog: is not drawn with medium.model = \"tetrahedra\""),
                                     std::pair("[[light]]\ntype = 'spot'\n", "points and spots are not drawn")}) {
        try {
            loadScene(tetrahedraScene(rest));
            ADD_FAILURE() << rest;
        } catch (const SceneError& error) {
            expectIn(error.what(), says);
        }
    }
    Simulation simulation(loadScene(tetrahedraScene()));
    give(simulation, {command(Add{.list = SceneList::fogs})});
    ASSERT_EQ(simulation.refused().size(), 1u);
    expectIn(simulation.refused()[0].why, "only with medium.model = \"sum\"");
    give(simulation, {command(Add{.list = SceneList::lights})});
    EXPECT_EQ(simulation.refused().size(), 1u);
}

TEST(Tetrahedra, AFileThatChangesWhileItIsReadIsRefused) {
    Scene scene = loadScene(tetrahedraScene());
    scene.medium.file = std::filesystem::path(testing::TempDir()) / "more_points.ply";
    std::ofstream(scene.medium.file)
        << "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
           "property float sigma_t\nelement tetrahedron 2\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n1 1 1 1\n4 0 1 2 3\n4 1 2 3 4\n";
    EXPECT_THROW(Simulation{scene}, SceneError);
}

TEST(PointClouds, NamesOfAFileAreSafeToShow) {
    const std::string line =
        told(cloudScene("property float a\x1b[2J\nproperty float " + std::string(900, 'b') + "\n", "0 0 0 1 1\n"));
    expectIn(line, "ignored properties: a?[2J, bbb");
    EXPECT_LT(line.size(), 1200u);
}

TEST(PointClouds, LeftOutPointsAreToldWithTheFirstReason) {
    const std::string lines = told(cloudScene("property float scale\n", "0 0 0 1\n1 0 0 0\n2 0 0 -1\n"));
    expectIn(lines, "dropped 2 of 3 points; the first, line 10: scale is 0; allowed: 0.001 to 100000\n");
}

TEST(PointClouds, ACameraThatSeesNoneIsToldWhereToStand) {
    const std::string millimetres = "3000 4000 5000\n3100 4000 5000\n3000 4100 5000\n",
                      wrong = "sees none of the 3 points";
    const auto with = [&](const std::string& rest) { return told(cloudScene("", millimetres, "scale = 50\n" + rest)); };
    const std::string lines = with("");
    expectIn(lines, wrong + ": they are in [3000, 4000, 5000] to [3100, 4100, 5000] m, the camera is at [0, 2, 26] and "
                            "looks at [0, 0, 0]; set camera.position = [");
    expectIn(lines, " and camera.target = [3050, 4050, 5000], ");
    const size_t begin = lines.find("camera.position"), middle = lines.find(" and camera.target");
    const std::string position = lines.substr(begin + 7, middle - begin - 7), target = "target = [3050, 4050, 5000]";
    const std::string advised = "[camera]\n" + position + '\n' + target + '\n';
    EXPECT_EQ(with(advised).find("sees none"), std::string::npos) << advised << with(advised);
    EXPECT_EQ(with("centre = [-3000, -4000, -5000]\n").find("sees none"), std::string::npos);

    for (const char* const behind : {"0 0 40\n1 0 40\n", "60 0 0\n61 0 0\n", "0 60 0\n1 60 0\n", "-60 0 0\n-61 0 0\n"})
        expectIn(told(cloudScene("", behind, "scale = 1\n")), "sees none of the 2 points");
    for (const char* const before : {"0 0 20\n1 0 20\n", "17 0 0\n16 0 0\n", "0 9 0\n0 60 0\n", "0 2 26.3\n1 90 27\n"})
        EXPECT_EQ(told(cloudScene("", before, "scale = 1\n")).find("sees none"), std::string::npos) << before;
}

TEST(PointClouds, PlacesAreToldInTheWorld) {
    const auto file = cloudScene("", "1000100 0 0\n1000101 0 0\n", "scale = 1\n");
    const std::string origin[] = {"origin=[1e6, 0, 0]"};
    const Scene scene = loadScene(file, origin);
    const Simulation simulation(scene);
    expectIn(pointCloudLine(scene, simulation), "2 points in [1000100, 0, 0] to [1000101, 0, 0] m");
    const auto warnings = pointCloudWarnings(scene, simulation);
    ASSERT_EQ(warnings.size(), 1u);
    expectIn(warnings[0], "the camera is at [1000000, 2, 26]");
}

} // namespace
} // namespace brume::point_cloud_test
