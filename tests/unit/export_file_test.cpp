// PLY files into volumes: sequences, sizes, and all that a user can get wrong.
#include "tools/import/export.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "common/scene.h"
#include "common/volume/volume.h"
#include "tests/unit/ply_file.h"
#include "tools/import/volume.h"

namespace brume::volumes::export_test {
namespace {

namespace fs = std::filesystem;

constexpr double kLittle = 2e-3; // of the mass, which is below --least
const std::string kSizes = "property float scale\nproperty float sigma_t\n";

struct ExportFile : testing::Test {
    fs::path folder = fs::path(testing::TempDir()) / "brume-export";

    ExportFile() { fs::create_directories(folder); }
    ~ExportFile() override { fs::remove_all(folder); }

    void put(const std::string& name, const std::string& points, const std::string& properties = kSizes) const {
        std::ofstream(folder / name) << test::asciiPly(properties, points);
    }
    ExportSettings settings(const std::string& in, const std::string& out) const {
        ExportSettings settings;
        settings.in = folder / in, settings.out = folder / out;
        return settings;
    }
    static std::vector<std::string> run(const ExportSettings& settings) {
        std::vector<std::string> said;
        exportFiles(settings, [&](const std::string& line) { said.push_back(line); });
        return said;
    }
    double massIn(const std::string& name) const { // m^2
        const Volume volume = readVolume(folder / name, {});
        return volume.voxels.sum() * std::pow(volume.width, 3);
    }
    std::string errorOf(const ExportSettings& settings) const {
        try {
            run(settings);
        } catch (const std::exception& error) {
            const std::string what = error.what(), where = folder.string() + '/';
            EXPECT_EQ(what.find('\n'), what.npos);
            return what.starts_with(where) ? what.substr(where.size()) : what;
        }
        return "no error";
    }
};

// Of a ball of scale 4 and extinction 0.5 in a scene of that falloff.
double massOfOne(double falloff) { return massOf({{}, 0.4 * falloff, 0.5}); }

TEST_F(ExportFile, NumberedFilesBecomeNumberedVolumes) {
    put("plume-000007.ply", "0 1 2 4 0.5\n");
    put("plume-000008.ply", "");
    put("plume-000012.ply", "0 1 2 4 0.5\n5 1 2 4 0.5\n");
    put("plume-13.ply", "0 1 2 4 0.5\n");
    EXPECT_EQ(run(settings("plume-######.ply", "out-####.vdb")).size(), 3u);
    EXPECT_NEAR(massIn("out-0007.vdb") / massOfOne(1.6), 1, kLittle);
    EXPECT_NEAR(massIn("out-0012.vdb") / massOfOne(1.6), 2, kLittle);
    EXPECT_TRUE(fs::exists(folder / "out-0008.vdb")) << "one without particles has no voxels";
    EXPECT_FALSE(fs::exists(folder / "out-0013.vdb"));
    EXPECT_EQ(errorOf(settings("plume-######.ply", "out-####.nrrd")), "plume-000008.ply: nothing is above --least");
    EXPECT_EQ(errorOf(settings("plume-######.ply", "out.vdb")),
              "a # for each digit of a frame's number is allowed in both names or in none");
    EXPECT_EQ(errorOf(settings("nothing-#.ply", "out-#.vdb")),
              "nothing-#.ply: no such file; expected numbered files, with a digit for each #");
}

TEST_F(ExportFile, SizesAreForTheFalloffThatTheHeaderSays) {
    const std::string file = test::asciiPly(kSizes, "0 1 2 4 0.5\n");
    std::string told = file;
    told.insert(told.find("element"), "comment scene x, tick 1; metres, y up; sizes for medium.falloff = 1.2\n");
    ExportSettings how = settings("", "a.vdb");
    std::vector<std::string> said;
    const Say say = [&](const std::string& line) { said.push_back(line); };
    exportBytes(file, "a.ply", how, say);
    EXPECT_NEAR(massIn("a.vdb") / massOfOne(1.6), 1, kLittle);
    EXPECT_EQ(said.back().find("falloff"), std::string::npos);
    exportBytes(told, "a.ply", how, say);
    EXPECT_NEAR(massIn("a.vdb") / massOfOne(1.2), 1, kLittle);
    EXPECT_TRUE(said.back().ends_with("; medium.falloff 1.2, as the header says")) << said.back();
    how.falloff = 2;
    exportBytes(told, "a.ply", how, say);
    EXPECT_NEAR(massIn("a.vdb") / massOfOne(2), 1, kLittle);
    for (const char* bad : {"nan", "99", "-1", "much"}) {
        std::string wrong = told;
        wrong.replace(wrong.find("1.2\n"), 3, bad);
        EXPECT_EQ(particlesOf(wrong, "a.ply", settings("", ""), say).falloff, 1.6) << bad;
    }
}

TEST_F(ExportFile, LostMassIsSaid) {
    put("thin.ply", "0.05 0.05 0.05 0.01 0.5\n0 0 0 4 0.0003\n");
    const std::vector<std::string> said = run(settings("thin.ply", "thin.vdb"));
    ASSERT_EQ(said.size(), 2u);
    EXPECT_NE(said[1].find("some are thinner than a voxel, or below --least"), std::string::npos);
}

TEST_F(ExportFile, WhatIsWrongIsSaidInOneLine) {
    EXPECT_EQ(errorOf(settings("nothing.ply", "a.vdb")), "nothing.ply: no such file");
    std::ofstream(folder / "text.ply") << "some text\n";
    EXPECT_EQ(errorOf(settings("text.ply", "a.vdb")),
              "text.ply:1: PLY: the first line is not \"ply\"; expected a PLY file");
    put("sizeless.ply", "0 0 0\n", "");
    EXPECT_EQ(errorOf(settings("sizeless.ply", "a.vdb")), "sizeless.ply: its points need a scale and a sigma_t");
    put("thin.ply", "0 0 0 4 0.00001\n");
    EXPECT_EQ(errorOf(settings("thin.ply", "a.vdb")), "thin.ply: nothing is above --least");
    put("far.ply", "40000 0 0 4 1\n");
    ExportSettings small = settings("far.ply", "a.vdb");
    small.voxel = 0.001;
    EXPECT_EQ(errorOf(small), "a particle lies too far from the origin for so small voxels: a larger --voxel");
    put("large.ply", "0 0 0 1000 1\n");
    small = settings("large.ply", "a.vdb");
    small.voxel = 0.01;
    EXPECT_EQ(errorOf(small), "a particle is too large for so small voxels: a larger --voxel");
    small.voxel = 0.2;
    EXPECT_EQ(errorOf(small), "more than 256000000 voxels would be needed: a larger --voxel");
    put("apart.ply", "-500 -500 -500 1 1\n500 500 500 1 1\n");
    EXPECT_EQ(errorOf(settings("apart.ply", "a.nrrd")).find("the box of all voxels has 1"), 0u);
    put("good.ply", "0 0 0 4 1\n");
    EXPECT_EQ(errorOf(settings("good.ply", "no/such/a.nrrd")), "no/such/a.nrrd: cannot be written");
    EXPECT_EQ(errorOf(settings("good.ply", "no/such/a.vdb")).find("no/such/a.vdb: cannot be written: "), 0u);
    EXPECT_EQ(errorOf(settings("good.ply", "a-#.vdb")),
              "a # for each digit of a frame's number is allowed in both names or in none");
}

} // namespace
} // namespace brume::volumes::export_test
