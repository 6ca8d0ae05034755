// VDB files into PLY files: places, sizes, colours, sequences, and all that a user can get wrong.
#include "tools/import/import.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include "common/ply/ply.h"
#include "common/scene.h"
#include "common/volume/volume.h"
#include "tools/import/rasterise.h"

namespace brume::volumes::file_test {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
    fs::path path = fs::path(testing::TempDir()) / "brume-import";
    fs::create_directories(path);
    return path;
}

// A ball around (8, 16, 24) of the file's unit, with voxels half a unit wide.
Volume ballVolume(double grow = 1) {
    const Ball ball{{16, 32, 48}, 3 * grow, 0.5, {0.25f, 0.5f, 1}};
    Raster raster = rasterised({&ball, 1}, 1e-4f, true);
    Volume out;
    out.voxels = std::move(raster.voxels);
    out.albedo = std::move(raster.albedo);
    out.width = 0.5;
    out.turn = glm::dmat3(0.5);
    return out;
}

std::string bytesOf(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

ImportSettings settingsOf(const std::string& in, const std::string& out) {
    ImportSettings settings;
    settings.in = folder() / in;
    settings.out = folder() / out;
    settings.fit.error = 0.02;
    return settings;
}

std::vector<std::string> run(const ImportSettings& settings, bool kept = true) {
    std::vector<std::string> said;
    EXPECT_EQ(importFiles(settings, [&](const std::string& line) { said.push_back(line); }).kept, kept);
    return said;
}

std::string errorOf(const ImportSettings& settings) {
    try {
        importFiles(settings, [](const std::string&) {});
    } catch (const ImportError& error) {
        const std::string what = error.what(), where = folder().string() + '/';
        return what.starts_with(where) ? what.substr(where.size()) : what;
    }
    return "no error";
}

void writeGrid(const std::string& name, const openvdb::GridBase::Ptr& grid) {
    openvdb::io::File file((folder() / name).string());
    file.write(openvdb::GridPtrVec{grid});
    file.close();
}

template <class Grid>
typename Grid::Ptr emptyGrid() {
    openvdb::initialize();
    auto grid = Grid::create();
    grid->setName("density");
    return grid;
}

// Mean place and mass (m^2) of a cloud.
std::pair<glm::dvec3, double> momentsOf(const PointCloud& cloud) {
    glm::dvec3 sum(0);
    double all = 0;
    for (size_t i = 0; i < cloud.position.size(); ++i) {
        const double deviation = double(cloud.scale[i]) * 1.6 / 10;
        const double mass = double(cloud.sigma_t[i]) * std::pow(2 * std::numbers::pi, 1.5) * std::pow(deviation, 3);
        sum += mass * glm::dvec3(cloud.position[i]);
        all += mass;
    }
    return {sum / all, all};
}

TEST(ImportFile, PlacesMassAndColours) {
    const Volume volume = ballVolume();
    writeVolume(folder() / "ball.vdb", volume);
    ImportSettings settings = settingsOf("ball.vdb", "ball.ply");
    settings.placing.density = 3;
    run(settings);
    const PointCloud cloud = loadPly(settings.out);
    const auto [middle, mass] = momentsOf(cloud);
    EXPECT_LT(glm::length(middle - glm::dvec3(8, 16, 24)), 0.01);
    EXPECT_NEAR(mass / (3 * volume.voxels.sum() * 0.125), 1, 1e-5);
    ASSERT_EQ(cloud.albedo.size(), cloud.position.size());
    for (const glm::vec3 albedo : cloud.albedo) EXPECT_LT(glm::length(albedo - glm::vec3(0.25f, 0.5f, 1)), 1e-3f);
    EXPECT_TRUE(cloud.ignored.empty());
}

TEST(ImportFile, AxesAndScale) {
    writeVolume(folder() / "ball.vdb", ballVolume());
    ImportSettings settings = settingsOf("ball.vdb", "turned.ply");
    settings.placing.z_up = true;
    settings.placing.scale = 0.5;
    settings.placing.falloff = 0.8;
    settings.wanted.albedo = "none";
    run(settings);
    const PointCloud cloud = loadPly(settings.out);
    const auto [middle, mass] = momentsOf(cloud); // with twice the true deviation, as the scene's falloff differs
    EXPECT_LT(glm::length(middle - glm::dvec3(4, 12, -8)), 0.01);
    EXPECT_NEAR(mass / (8 * ballVolume().voxels.sum() / 64), 1, 1e-5);
    EXPECT_TRUE(cloud.albedo.empty());
}

TEST(ImportFile, TwoRunsGiveTheSameBytes) {
    writeVolume(folder() / "ball.vdb", ballVolume());
    run(settingsOf("ball.vdb", "a.ply"));
    run(settingsOf("ball.vdb", "b.ply"));
    EXPECT_EQ(bytesOf(folder() / "a.ply"), bytesOf(folder() / "b.ply"));
    EXPECT_NE(bytesOf(folder() / "a.ply").find("comment made by brume-import from ball.vdb\n"), std::string::npos);
}

TEST(ImportFile, CellsOfASequenceKeepTheirIds) {
    for (int frame : {1, 2, 4}) {
        Volume volume = ballVolume(frame == 4 ? 1.2 : 1);
        if (frame == 2) volume.albedo.clear(); // the first file's properties are all files'
        volume.velocity.assign(volume.voxels.values().size(), glm::vec3(0, 1, 0));
        writeVolume(folder() / ("frame_00" + std::to_string(frame) + ".vdb"), volume);
    }
    ImportSettings settings = settingsOf("frame_###.vdb", "frame_###.ply");
    settings.wanted.velocity = "none";
    const std::vector<std::string> said = run(settings);
    EXPECT_NE(std::ranges::find_if(said, [](const std::string& s) { return s.ends_with("velocity is ignored"); }),
              said.end());
    const auto load = [](int frame) {
        return loadPly(folder() / ("frame_00" + std::to_string(frame) + ".ply"), {}, {.ids = true});
    };
    const PointCloud first = load(1), second = load(2), last = load(4);
    EXPECT_EQ(first.id, second.id);
    EXPECT_EQ(first.position, second.position);
    EXPECT_EQ(first.albedo.size(), second.albedo.size());
    EXPECT_EQ(std::set<int64_t>(last.id.begin(), last.id.end()).size(), last.id.size());
    EXPECT_TRUE(std::ranges::any_of(last.id, [&](int64_t id) { return std::ranges::count(first.id, id) > 0; }));
}

TEST(ImportFile, PointsOfASequenceHaveTheVoxelsVelocities) {
    for (int frame : {1, 2}) {
        Volume volume = ballVolume();
        if (frame == 1) volume.velocity.assign(volume.voxels.values().size(), glm::vec3(1, 2, 3));
        writeVolume(folder() / ("moved_00" + std::to_string(frame) + ".vdb"), volume);
    }
    ImportSettings settings = settingsOf("moved_###.vdb", "moved_###.ply");
    settings.placing.z_up = true;
    settings.placing.scale = 0.5;
    const std::vector<std::string> said = run(settings);
    EXPECT_NE(std::ranges::find_if(said,
                                   [](const std::string& s) {
                                       return s.ends_with("no velocity, unlike in the first file; 0 is taken");
                                   }),
              said.end());
    const auto load = [](int frame) {
        return loadPly(folder() / ("moved_00" + std::to_string(frame) + ".ply"), {}, {.ids = true, .velocities = true});
    };
    const PointCloud first = load(1), second = load(2);
    EXPECT_TRUE(first.id.empty());
    ASSERT_FALSE(first.velocity.empty());
    for (const glm::vec3& velocity : first.velocity) EXPECT_LT(glm::distance(velocity, {0.5f, 1.5f, -1}), 1e-5f);
    ASSERT_EQ(second.velocity.size(), second.position.size());
    EXPECT_EQ(second.velocity.front(), glm::vec3(0));
}

// The voxels themselves, read back at their places.
TEST(ImportFile, VoxelsAreWrittenAsTheyAre) {
    const Volume ball = ballVolume();
    writeVolume(folder() / "ball.vdb", ball);
    ImportSettings settings = settingsOf("ball.vdb", "ball.nrrd");
    settings.placing.z_up = true, settings.placing.scale = 0.5, settings.placing.density = 3;
    const std::vector<std::string> said = run(settings);
    EXPECT_NE(said.back().find("voxels above 0"), std::string::npos) << said.back();
    const brume::Volume read = loadVolume(settings.out, {}, 1u << 24);
    double sum = 0;
    for (const float extinction : read.extinction) sum += double(extinction);
    EXPECT_NEAR(sum / (3 * ball.voxels.sum()), 1, 1e-6);
    EXPECT_NEAR(read.spacing, 0.5 * ball.width, 1e-9);
    const glm::ivec3 voxel = (ball.voxels.lo() + ball.voxels.hi()) / 2;
    const glm::dvec3 in_file = ball.turn * glm::dvec3(voxel) + ball.origin;
    const glm::dvec3 there = 0.5 * glm::dvec3(in_file.x, in_file.z, -in_file.y),
                     at = (there - read.origin) / read.spacing;
    EXPECT_LT(glm::length(at - glm::round(at)), 1e-6);
    EXPECT_FLOAT_EQ(read.at(glm::ivec3(glm::round(at))), 3 * ball.voxels.at(voxel));
}

TEST(ImportFile, TilesTypesAndLevelSets) {
    auto tile = emptyGrid<openvdb::FloatGrid>();
    tile->fill(openvdb::CoordBBox({0, 0, 0}, {15, 15, 7}), 2.0f, true);
    tile->tree().setValue({20, 0, 0}, -1);
    tile->tree().setValue({21, 0, 0}, std::numeric_limits<float>::infinity());
    tile->tree().setValue({-1, 0, 0}, 3);
    writeGrid("tile.vdb", tile);
    const Volume tiles = readVolume(folder() / "tile.vdb", {});
    EXPECT_EQ(tiles.voxels.active(), 16u * 16 * 8 + 1);
    EXPECT_EQ(tiles.voxels.at({15, 8, 7}), 2);
    EXPECT_EQ(tiles.voxels.at({-1, 0, 0}), 3);
    EXPECT_EQ(tiles.voxels.at({20, 0, 0}), 0);
    EXPECT_EQ(tiles.notes,
              (std::vector<std::string>{"1 negative values are taken as 0", "1 values are not finite and taken as 0"}));
    auto whole = emptyGrid<openvdb::Int32Grid>();
    whole->tree().setValue({1, 2, 3}, 7);
    writeGrid("whole.vdb", whole);
    EXPECT_EQ(readVolume(folder() / "whole.vdb", {}).voxels.at({1, 2, 3}), 7);
    const auto sphere = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(10, {0, 0, 0}, 0.5f);
    sphere->setName("density");
    writeGrid("sphere.vdb", sphere);
    const Volume fog = readVolume(folder() / "sphere.vdb", {});
    EXPECT_EQ(fog.voxels.at({0, 0, 0}), 1);
    EXPECT_NEAR(fog.voxels.at({19, 0, 0}), 0.5 / 1.5, 0.01); // half a unit inside, of a band of 1.5
    EXPECT_EQ(fog.voxels.at({21, 0, 0}), 0);
}

TEST(ImportFile, WhatIsWrongIsSaidInOneLine) {
    EXPECT_EQ(errorOf(settingsOf("nothing.vdb", "a.ply")), "nothing.vdb: no such file");
    std::ofstream(folder() / "text.vdb") << "no volume at all, but some text that is long enough";
    EXPECT_EQ(errorOf(settingsOf("text.vdb", "a.ply")).find("text.vdb: cannot be read as VDB: "), 0u);
    std::ofstream(folder() / "nothing-in.vdb").flush();
    EXPECT_EQ(errorOf(settingsOf("nothing-in.vdb", "a.ply")).find("nothing-in.vdb: cannot be read as VDB: "), 0u);
    writeVolume(folder() / "ball.vdb", ballVolume());
    ImportSettings other = settingsOf("ball.vdb", "a.ply");
    other.wanted.grid = "fuel";
    EXPECT_EQ(errorOf(other), "ball.vdb: no grid fuel; there are: albedo (vec3s), density (float)");
    other.wanted.grid = "albedo";
    EXPECT_EQ(errorOf(other), "ball.vdb: grid albedo is of type vec3s; allowed: one number a voxel");
    writeGrid("empty.vdb", emptyGrid<openvdb::FloatGrid>());
    EXPECT_EQ(errorOf(settingsOf("empty.vdb", "a.ply")), "empty.vdb: grid density has no voxel above 0");
    auto many = emptyGrid<openvdb::FloatGrid>();
    many->fill(openvdb::CoordBBox({0, 0, 0}, {1023, 1023, 255}), 1.0f, true);
    writeGrid("many.vdb", many);
    EXPECT_EQ(errorOf(settingsOf("many.vdb", "a.ply")),
              "many.vdb: grid density has 268435456 active voxels; allowed: 256000000");
    auto flat = emptyGrid<openvdb::FloatGrid>();
    flat->tree().setValue({0, 0, 0}, 1);
    flat->setTransform(openvdb::math::Transform::createLinearTransform(
        openvdb::math::Mat4d(1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 2., 0., 0., 0., 0., 1.)));
    writeGrid("flat.vdb", flat);
    EXPECT_EQ(errorOf(settingsOf("flat.vdb", "a.ply")),
              "flat.vdb: its voxels are 1 x 1 x 2 wide, or skew; allowed: cubes");
    EXPECT_EQ(errorOf(settingsOf("ball.vdb", "no/such/folder/a.ply")), "no/such/folder/a.ply: cannot be written");
    EXPECT_EQ(errorOf(settingsOf("ball.vdb", "a_##.ply")),
              "a # for each digit of a frame's number is allowed in both names or in none");
    ImportSettings dense = settingsOf("ball.vdb", "a.ply");
    dense.placing.density = 1e6;
    dense.fit.error = 1;
    EXPECT_EQ(errorOf(dense).find("a particle's extinction would be "), 0u);
}

TEST(ImportFile, AMissedBoundIsSaid) {
    writeVolume(folder() / "ball.vdb", ballVolume());
    ImportSettings settings = settingsOf("ball.vdb", "few.ply");
    settings.fit.error = 1e-4;
    settings.fit.most = 3;
    const std::vector<std::string> said = run(settings, false);
    EXPECT_TRUE(said.back().ends_with("allowed 0.0001: a larger --most, or a larger --error")) << said.back();
    EXPECT_LE(loadPly(settings.out).position.size(), 3u);
}

} // namespace
} // namespace brume::volumes::file_test
