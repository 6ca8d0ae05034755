// Files of 3D Gaussian splatting as point clouds.
#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "common/ply/ply.h"
#include "common/scene.h"
#include "shaders/shared/ellipsoid.h"
#include "tests/unit/ply_file.h"

namespace brume::ply_splats_test {
namespace {

using test::asciiPly, test::raw;

const std::string kSplat = "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n"
                           "property float opacity\nproperty float scale_0\nproperty float scale_1\n"
                           "property float scale_2\nproperty float rot_0\nproperty float rot_1\n"
                           "property float rot_2\nproperty float rot_3\n";

PointCloud read(const std::string& bytes) { return parsePly(bytes, "s.ply"); }

bool tells(const PointCloud& cloud, const std::string& what) {
    for (const std::string& note : cloud.notes)
        if (note.find(what) != note.npos) return true;
    return false;
}

TEST(Splats, AreReadForWhatTheyMean) {
    const PointCloud cloud = read(asciiPly(kSplat, "0 0 0 1.77 -1.77 0 2.0 -1 -1 -1 1 0 0 0\n"
                                                   "1 0 0 0 0 0 0.5 -1 -1 -1 1 0 0 0\n"
                                                   "0 2 0 0 0 0 -1.0 -1 -1 -1 1 0 0 0\n"
                                                   "0 0 3 9 0 -9 3.0 -1 -2 -3 1 0 0 0\n"));
    ASSERT_EQ(cloud.position.size(), 4u) << "never a part of them";
    EXPECT_EQ(cloud.dropped, 0u);
    for (const auto& [i, opacity] : {std::pair(0u, 0.8808f), {1u, 0.6225f}, {2u, 0.2689f}, {3u, 0.9526f}})
        EXPECT_NEAR(cloud.opacity[i], opacity, 1e-4f);
    EXPECT_NEAR(cloud.deviation[0], 0.36788f, 1e-5f);
    EXPECT_NEAR(cloud.deviation[3], std::exp(-2.0f), 1e-6f) << "a ball of the same volume";
    EXPECT_NEAR(cloud.albedo[0].x, 0.9993f, 1e-4f);
    EXPECT_NEAR(cloud.albedo[0].y, 0.0007f, 1e-4f);
    EXPECT_NEAR(cloud.albedo[0].z, 0.5f, 1e-6f);
    EXPECT_EQ(cloud.albedo[3], glm::vec3(1, 0.5f, 0)) << "brought into the range of an albedo";
    EXPECT_TRUE(tells(cloud, "Gaussian splatting"));
    EXPECT_TRUE(cloud.ignored.empty());
}

TEST(Splats, WhatIsLostIsTold) {
    std::string rest, values;
    for (int i = 0; i < 45; ++i) rest += "property float f_rest_" + std::to_string(i) + "\n", values += " 0.1";
    const PointCloud cloud =
        read(asciiPly(kSplat + rest + "property float nx\n", "0 0 0 0 0 0 2.5 -1 -1 -1 1 0 0 0" + values + " 0\n"));
    EXPECT_TRUE(tells(cloud, "the same from all sides (45 numbers of each are not read)"));
    EXPECT_EQ(cloud.ignored, std::vector<std::string>{"nx"});
    EXPECT_NEAR(cloud.opacity[0], 0.9241f, 1e-4f);
}

TEST(Splats, DiscsAndBallsAreSplatsToo) {
    std::string disc = kSplat, ball = kSplat;
    disc.erase(disc.find("property float scale_2\n"), 23);
    ball.erase(ball.find("property float scale_1\n"), 46);
    EXPECT_NEAR(read(asciiPly(disc, "0 0 0 0 0 0 2.5 -1 -4 1 0 0 0\n")).deviation[0], std::exp(-3.0f), 1e-6f);
    EXPECT_NEAR(read(asciiPly(ball, "0 0 0 0 0 0 2.5 -2 1 0 0 0\n")).deviation[0], std::exp(-2.0f), 1e-6f);
}

TEST(Splats, LengthsAreInTheFilesUnit) {
    const PointCloud cloud =
        parsePly(asciiPly(kSplat, "2 0 0 0 0 0 2.5 0 0 0 1 0 0 0\n"), "s.ply", {.unit = 0.1, .up = "-y"});
    EXPECT_NEAR(cloud.deviation[0], 0.1f, 1e-7f);
    EXPECT_NEAR(cloud.opacity[0], 0.9241f, 1e-4f) << "what a ray through it loses stays";
}

// Of a turned disc: rot is a quarter turn about z, so that the file's first axis is y.
TEST(Splats, AxesAreTurnedAsTheFileSays) {
    const std::string disc = asciiPly(kSplat, "0 0 0 0 0 0 2 0 -1 -3 0.70710678 0 0 0.70710678\n");
    const PointCloud cloud = parsePly(disc, "s.ply", {}, {.axes = true});
    ASSERT_EQ(cloud.axes.size(), 1u);
    EXPECT_NEAR(cloud.deviation[0], 1, 1e-6) << "that of the longest";
    const auto near = [](glm::vec3 a, glm::vec3 b) { return glm::length(a - b) < 1e-6f; };
    EXPECT_TRUE(near(cloud.axes[0].a, {0, 1, 0}));
    EXPECT_TRUE(near(cloud.axes[0].b, {-std::exp(-1.0f), 0, 0}));
    EXPECT_TRUE(near(cloud.axes[0].c, {0, 0, std::exp(-3.0f)}));
    EXPECT_TRUE(tells(cloud, "splats are ellipsoids"));
    const PointCloud lying = parsePly(disc, "s.ply", {.up = "z"}, {.axes = true}); // y of the file is -z here
    EXPECT_TRUE(near(lying.axes[0].a, {0, 0, -1}));
    EXPECT_TRUE(near(lying.axes[0].c, {0, std::exp(-3.0f), 0}));
    EXPECT_TRUE(tells(read(disc), "medium.model = \"ellipsoids\" keeps their axes"));
}

TEST(Splats, AxesThatAreNoneAreFlatOrTheWorlds) {
    std::string two = kSplat;
    two.erase(two.find("property float scale_2\n"), 23);
    const PointCloud flat = parsePly(asciiPly(two, "0 0 0 0 0 0 2 0 -1 1 0 0 0\n"), "s.ply", {}, {.axes = true});
    EXPECT_NEAR(glm::length(flat.axes[0].c), gpu::kLeastAxis, 1e-6f) << "a disc";
    const PointCloud still = parsePly(asciiPly(kSplat, "0 0 0 0 0 0 2 0 0 0 0 0 0 0\n"), "s.ply", {}, {.axes = true});
    EXPECT_EQ(still.axes[0].a, glm::vec3(1, 0, 0)) << "a rotation of zeros is none";
}

TEST(Splats, NumbersThatAreNoneDropTheirSplatAlone) {
    const PointCloud cloud = read(asciiPly(kSplat, "0 0 0 0 0 0 nan -1 -1 -1 1 0 0 0\n1 0 0 0 0 0 1 inf -1 -1 1 0 0 0\n"
                                                   "2 0 0 0 0 0 1 -1 -1 -1 1 0 0 0\n"));
    EXPECT_EQ(cloud.position.size(), 1u);
    EXPECT_EQ(cloud.dropped, 2u);
    EXPECT_EQ(cloud.first_dropped.find("line 19: opacity is "), 0u) << cloud.first_dropped;
}

// The packed form: two chunks of 256, of which the second has one splat.
struct Packed {
    bool coloured = true; // true: chunks have the extremes of colours
    uint32_t splats = 257;
    std::string header(uint32_t chunks) const {
        std::string out = "ply\nformat binary_little_endian 1.0\nelement chunk " + std::to_string(chunks) + "\n";
        for (const char* name : {"x", "y", "z", "scale_x", "scale_y", "scale_z", "r", "g", "b"})
            for (const char* end : {"min_", "max_"})
                if (coloured || std::string(name).size() != 1 || *name > 's') // r, g, b come before s
                    out += std::string("property float ") + end + name + "\n";
        out += "element vertex " + std::to_string(splats) + "\n";
        for (const char* name : {"position", "rotation", "scale", "color"})
            out += std::string("property uint packed_") + name + "\n";
        return out + "end_header\n";
    }
    std::string bytes() const {
        std::string out = header(2);
        for (int chunk = 0; chunk < 2; ++chunk) {
            for (const float x : {-1.0f, 1.0f, 0.0f, 4.0f, 10.0f, 20.0f}) out += raw(x + 100 * chunk);
            for (int i = 0; i < 3; ++i) out += raw(-5.0f) + raw(-1.0f);
            for (int i = 0; coloured && i < 3; ++i) out += raw(0.5f) + raw(1.0f);
        }
        for (uint32_t i = 0; i < splats; ++i)
            out += raw(2047u << 21 | 0u << 11 | 2047u) + raw(0u) + raw(0u << 21 | 1023u << 11 | 2047u) +
                   raw(0xff'00'33'80u);
        return out;
    }
};

TEST(Splats, ThePackedFormIsReadToo) {
    for (const bool coloured : {true, false}) {
        const PointCloud cloud = read(Packed{.coloured = coloured}.bytes());
        ASSERT_EQ(cloud.position.size(), 257u);
        EXPECT_EQ(cloud.position[0], glm::vec3(1, 0, 20));
        EXPECT_EQ(cloud.position[256], glm::vec3(101, 100, 120)) << "the second chunk's box";
        EXPECT_NEAR(cloud.deviation[0], std::exp((-5.0f - 1 - 1) / 3), 1e-6f);
        EXPECT_NEAR(cloud.opacity[0], 128 / 255.0f, 1e-6f);
        EXPECT_NEAR(cloud.albedo[0].x, 1, 1e-6f);
        EXPECT_NEAR(cloud.albedo[0].y, coloured ? 0.5f : 0, 1e-6f);
        EXPECT_NEAR(cloud.albedo[0].z, coloured ? 0.6f : 0.2f, 1e-6f);
        EXPECT_TRUE(tells(cloud, "Gaussian splatting"));
    }
}

TEST(Splats, APackedFileThatLacksSomethingSaysSo) {
    const auto refusal = [](const std::string& bytes) -> std::string {
        try {
            read(bytes);
        } catch (const SceneError& error) {
            return error.what();
        }
        return "no error";
    };
    const std::string bare = "ply\nformat ascii 1.0\nelement chunk 1\nproperty float min_x\nproperty float max_x\n"
                             "element vertex 2\nproperty uint packed_position\nproperty uint packed_rotation\n"
                             "end_header\n0 1\n1 0\n2 0\n";
    EXPECT_NE(refusal(bare).find("packed Gaussian splats (element chunk, packed_position)"), std::string::npos);
    const std::string whole = Packed().bytes();
    for (const size_t length : {whole.size() - 1, whole.size() - 3000, size_t(700)})
        EXPECT_NE(refusal(whole.substr(0, length)).find("ends"), std::string::npos) << length;
    EXPECT_NE(refusal(Packed{.splats = 513}.bytes()).find("2 rows of element chunk before 513 rows"),
              std::string::npos);
}

} // namespace
} // namespace brume::ply_splats_test
