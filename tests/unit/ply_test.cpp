// Point clouds: every form that is read, and every way in which a file can be broken.
#include "common/ply/ply.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/scene.h"

namespace brume::ply_test {
namespace {

PointCloud load(const std::string& bytes) { return parsePly(bytes, "ply_test.ply"); }

std::string errorOf(const std::string& bytes) {
    try {
        load(bytes);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no error";
}

template <class T>
std::string raw(T value) {
    std::string out(sizeof(T), '\0');
    std::memcpy(out.data(), &value, sizeof(T));
    return out;
}

const std::string kAscii = "ply\nformat ascii 1.0\n", kBinary = "ply\nformat binary_little_endian 1.0\n";
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

TEST(Ply, AsciiWithEverything) {
    const PointCloud cloud = load(kAscii + "comment made by hand\nobj_info none\nelement vertex 2\n" + kXyz +
                                  "property float nx\nproperty float scale\nproperty double sigma_t\n"
                                  "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
                                  "1 2 3 0 0.5 7 255 0 51\n-1e0 +2.5 .25 9 2 0.125 0 255 102\n");
    ASSERT_EQ(cloud.position.size(), 2u);
    EXPECT_EQ(cloud.position[0], glm::vec3(1, 2, 3));
    EXPECT_EQ(cloud.position[1], glm::vec3(-1, 2.5f, 0.25f));
    EXPECT_EQ(cloud.scale, (std::vector<float>{0.5f, 2}));
    EXPECT_EQ(cloud.sigma_t, (std::vector<float>{7, 0.125f}));
    EXPECT_EQ(cloud.albedo[0], glm::vec3(1, 0, 0.2f));
    EXPECT_EQ(cloud.albedo[1], glm::vec3(0, 1, 0.4f));
    EXPECT_EQ(cloud.dropped, 0u);
}

TEST(Ply, OnlyPlaces) {
    const PointCloud cloud = load(kAscii + "element vertex 1\n" + kXyz + "end_header\r\n4 5 6");
    ASSERT_EQ(cloud.position.size(), 1u);
    EXPECT_EQ(cloud.position[0], glm::vec3(4, 5, 6));
    EXPECT_TRUE(cloud.scale.empty() && cloud.sigma_t.empty() && cloud.albedo.empty());
}

TEST(Ply, NamesOfOtherPrograms) {
    const PointCloud cloud = load(kAscii + "element vertex 1\n" + kXyz +
                                  "property float radius\nproperty uchar opacity\nproperty float nx\n"
                                  "property uchar diffuse_red\nproperty uchar diffuse_green\n"
                                  "property uchar diffuse_blue\nproperty list uchar int faces\nend_header\n"
                                  "1 2 3 0.5 51 9 255 0 51 2 7 8\n");
    EXPECT_TRUE(cloud.scale.empty() && cloud.sigma_t.empty());
    EXPECT_EQ(cloud.radius, std::vector<float>{0.5f});
    EXPECT_EQ(cloud.opacity, std::vector<float>{0.2f});
    EXPECT_EQ(cloud.albedo, std::vector<glm::vec3>{glm::vec3(1, 0, 0.2f)});
    EXPECT_EQ(cloud.ignored, (std::vector<std::string>{"nx", "faces"}));
}

TEST(Ply, OurOwnNamesComeFirst) {
    const PointCloud cloud = load(kAscii + "element vertex 1\n" + kXyz +
                                  "property float radius\nproperty float opacity\nproperty float scale\n"
                                  "property float sigma_t\nproperty float diffuse_red\nproperty float red\n"
                                  "property float green\nproperty float blue\nend_header\n1 2 3 4 5 6 7 8 0 .5 1\n");
    EXPECT_EQ(cloud.scale, std::vector<float>{6});
    EXPECT_EQ(cloud.sigma_t, std::vector<float>{7});
    EXPECT_TRUE(cloud.radius.empty() && cloud.opacity.empty());
    EXPECT_EQ(cloud.albedo, std::vector<glm::vec3>{glm::vec3(0, 0.5f, 1)});
    EXPECT_EQ(cloud.ignored, (std::vector<std::string>{"radius", "opacity", "diffuse_red"}));
}

TEST(Ply, BinaryWithOtherElementsAndLists) {
    const std::string body = raw<uint8_t>(2) + raw(1) + raw(2) + raw<uint8_t>(0) + // 2 faces
                             raw(7.0) + raw(8.0) +                                 // 1 grid of two doubles
                             raw<uint8_t>(200) + raw(1.5) + raw<uint16_t>(2) + raw(3.0f) + raw(4.0f) + raw(-2.0f) +
                             raw<int8_t>(5) + raw(0.25f) + raw(0.5f) + raw(1.0f) + "trailing";
    const PointCloud cloud =
        load(kBinary +
             "element face 2\nproperty list uchar int vertex_indices\n"
             "element grid 1\nproperty double a\nproperty double b\n"
             "element nothing 18446744073709551615\n"
             "element vertex 1\nproperty uint8 flag\nproperty float64 x\nproperty list ushort float32 weights\n"
             "property float32 z\nproperty int8 y\n"
             "property float red\nproperty float green\nproperty float blue\nend_header\n" +
             body);
    ASSERT_EQ(cloud.position.size(), 1u);
    EXPECT_EQ(cloud.position[0], glm::vec3(1.5f, 5, -2));
    EXPECT_EQ(cloud.albedo[0], glm::vec3(0.25f, 0.5f, 1));
}

TEST(Ply, PointsThatCannotBeUsedAreDroppedAndCounted) {
    const std::string nan = raw(std::numeric_limits<float>::quiet_NaN()),
                      inf = raw(std::numeric_limits<float>::infinity());
    const std::string one = raw(1.0f);
    const PointCloud binary = load(kBinary + "element vertex 5\n" + kXyz + "property float scale\nend_header\n" + nan +
                                   one + one + one + one + inf + one + one + one + one + raw(2.0f) + one + one + one +
                                   one + raw(0.0f) + one + one + raw(1e9f) + one);
    ASSERT_EQ(binary.position.size(), 1u);
    EXPECT_EQ(binary.position[0], glm::vec3(1, 1, 2));
    EXPECT_EQ(binary.scale.size(), 1u);
    EXPECT_EQ(binary.dropped, 4u);
    EXPECT_EQ(binary.first_dropped.substr(0, 17), "row 1: x is nan; ");
    const PointCloud ascii =
        load(kAscii + "element vertex 4\n" + kXyz + "end_header\nnan 1 1\n1 -inf 1\n1 1 1e999\n1 2 3\n");
    EXPECT_EQ(ascii.position.size(), 1u);
    EXPECT_EQ(ascii.dropped, 3u);
    const PointCloud coloured = load(kAscii + "element vertex 2\n" + kXyz +
                                     "property float red\nproperty float green\nproperty float blue\nend_header\n"
                                     "1 1 1 0 0 1\n\n1 1 1 0 -0.5 0\n");
    EXPECT_EQ(coloured.first_dropped, "line 13: green is -0.5; allowed: 0 to 1");
}

struct Broken {
    std::string bytes;
    const char* says;
};

TEST(Ply, BrokenFilesSayWhatIsExpected) {
    const std::string vertex1 = "element vertex 1\n" + kXyz + "end_header\n";
    const std::vector<Broken> all{
        {"", "ends inside its header"},
        {"plY\n", "first line is not \"ply\""},
        {std::string(100, 'x'), "ends inside its header"},
        {"plyformat ascii 1.0element vertex 1", "sent with curl -d? It takes out line ends: use --data-binary"},
        {"ply\n" + std::string(2000, 'x') + "\n", "longer than 1024"},
        {kAscii, "expected end_header"},
        {"ply\nformat ascii 2.0\n" + vertex1, "expected \"format ascii 1.0\""},
        {"ply\nformat morse 1.0\n" + vertex1, "unknown format"},
        {"ply\n" + vertex1 + "1 2 3", "no format line"},
        {kAscii + "element vertex\n", "expected \"element"},
        {kAscii + "element vertex -1\n", "expected \"element"},
        {kAscii + "element vertex 99999999999999999999999\n", "expected \"element"},
        {kAscii + "property float x\n", "before any element"},
        {kAscii + "element vertex 1\nproperty quad x\n", "unknown type"},
        {kAscii + "element vertex 1\nproperty float\n", "expected \"property"},
        {kAscii + "element vertex 1\nproperty list float int x\n", "whole-number type"},
        {kAscii + "element vertex 1\nproperty list uchar int x\n" + kXyz.substr(17) + "end_header\n1 1 1 1",
         "is a list"},
        {kAscii + "element vertex 1\n" + kXyz + "property int x\nend_header\n1 1 1 1", "there twice"},
        {kAscii + "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 1", "lacks one of x, y, z"},
        {kAscii + "element face 0\nproperty list uchar int i\nend_header\n", "no element vertex"},
        {kAscii + "element vertex 0\n" + kXyz + "end_header\n", "allowed: 1 to 1000000"},
        {kAscii + "element vertex 1000001\n" + kXyz + "end_header\n", "allowed: 1 to 1000000"},
        {kAscii + vertex1, "ends early"},
        {kAscii + "element vertex 2\n" + kXyz + "end_header\n1 2 3\n", "after 1 of 2 rows of element vertex"},
        {kAscii + vertex1 + "1 2", ":8: PLY: the line has 2 values; a row of element vertex has 3: x, y, z"},
        {kAscii + "element vertex 2\n" + kXyz + "end_header\n1 2\n4 5 6\n", ":8: PLY: the line has 2 values; a row"},
        {kAscii + "element vertex 1\n" + kXyz + "end_header\n1 2 3 4\n", ":8: PLY: the line has 4 values; a row"},
        {kAscii + vertex1 + "1 two 3", ":8: PLY: property y: \"two\" is not a number"},
        {kAscii + "comment\n" + vertex1 + "\n\n1 2 0,5",
         ":11: PLY: property z: \"0,5\" is not a number; is its comma a decimal point? expected 0.5"},
        {kAscii + vertex1 + "1 2 3x", "\"3x\" is not a number"},
        {kAscii + vertex1 + "1 2 \x1b[2J", "\"?[2J\" is not a number"}, // shown, not done
        {kAscii + vertex1 + "nan nan nan", "no point is usable; the first, line 8: x is nan; allowed: finite"},
        {kBinary + vertex1 + raw(1.0f) + raw(2.0f) + "abc", "ends early, in row 1 of 1 of element vertex, property z"},
        {kBinary + "element face 4294967296\nproperty double a\n" + vertex1 + raw(1.0), "ends early"},
        {kBinary + "element face 2305843009213693952\nproperty double a\n" + vertex1 + raw(1.0),
         "ends early"}, // 8 times it is 2^64
        {kBinary + "element face 1\nproperty list int char i\n" + vertex1 + raw(-1),
         "row 1 of element face, property i: a list's length is -1"},
        {kBinary + "element face 1\nproperty list uint double i\n" + vertex1 + raw(0xffffffffu) + "1234",
         "a list's length"},
        {kAscii + "element face 1\nproperty list uchar char i\n" + vertex1 + "1.5 1 1 1 1",
         ":10: PLY: property i: a list's length is 1.5"},
    };
    for (const Broken& broken : all) {
        const std::string message = errorOf(broken.bytes);
        EXPECT_NE(message.find(broken.says), std::string::npos)
            << "expected \"" << broken.says << "\", got: " << message;
        EXPECT_NE(message.find("ply_test.ply"), std::string::npos) << message;
    }
}

TEST(Ply, HeadersAreBounded) {
    std::string many = kAscii;
    for (int i = 0; i < 300; ++i) many += "element e" + std::to_string(i) + " 0\n";
    EXPECT_NE(errorOf(many + "end_header\n").find("more than 256 elements"), std::string::npos);
    many = kAscii + "element vertex 1\n";
    for (int i = 0; i < 1100; ++i) many += "property float p" + std::to_string(i) + "\n";
    EXPECT_NE(errorOf(many + "end_header\n").find("more than 1024 properties"), std::string::npos);
    many = kAscii;
    for (int i = 0; i < 21'000; ++i) many += "comment\n";
    EXPECT_NE(errorOf(many + "end_header\n").find("more than 20000 lines"), std::string::npos);
    EXPECT_NE(errorOf(kAscii + "comment " + std::string(2 << 20, 'x') + "\nend_header\n").find("longer than 1 MiB"),
              std::string::npos);
}

// Every prefix of a good file, and every single byte of it changed, either loads or throws SceneError; nothing else.
TEST(Ply, NothingElseHappens) {
    const std::string good = kBinary + "element face 1\nproperty list uchar short i\nelement vertex 2\n" + kXyz +
                             "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n" +
                             raw<uint8_t>(2) + raw<int16_t>(1) + raw<int16_t>(2) + raw(1.0f) + raw(2.0f) + raw(3.0f) +
                             "abc" + raw(4.0f) + raw(5.0f) + raw(6.0f) + "def";
    ASSERT_EQ(load(good).position.size(), 2u);
    for (size_t n = 0; n < good.size(); ++n) EXPECT_THROW(load(good.substr(0, n)), SceneError) << n;
    for (size_t n = 0; n < good.size(); ++n) {
        std::string bad = good;
        bad[n] = static_cast<char>(bad[n] ^ 0x15);
        try {
            load(bad);
        } catch (const SceneError&) {
        }
    }
}

const std::string kCorners = "element vertex 5\n" + kXyz + "property float sigma_t\n",
                  kPoints = "0 0 0 0\n1 0 0 1\n0 1 0 2\n0 0 1 3\n1 1 1 0\n",
                  kCells = "element tetrahedron 2\nproperty list uchar int vertex_indices\n";

PointCloud tetrahedra(const std::string& bytes) { return parsePly(bytes, "ply_test.ply", {}, {.tetrahedra = true}); }

std::string tetrahedraError(const std::string& bytes) {
    try {
        tetrahedra(bytes);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no error";
}

TEST(Ply, TetrahedraInText) {
    const std::string file = kAscii + kCorners + kCells + "end_header\n" + kPoints + "4 0 1 2 3\n4 4 3 2 1\n";
    const PointCloud cloud = tetrahedra(file);
    EXPECT_EQ(cloud.position.size(), 5u);
    EXPECT_EQ(cloud.position[4], glm::vec3(1));
    EXPECT_EQ(cloud.sigma_t, (std::vector<float>{0, 1, 2, 3, 0}));
    EXPECT_EQ(cloud.tetrahedra, (std::vector<glm::uvec4>{{0, 1, 2, 3}, {4, 3, 2, 1}}));
    EXPECT_TRUE(load(file).tetrahedra.empty()) << "nobody asked for them";
}

TEST(Ply, TetrahedraBeforeTheirPointsAndWithOtherProperties) {
    const std::string body = raw(0.5) + raw(4) + raw<uint16_t>(0) + raw<uint16_t>(3) + raw<uint16_t>(2) +
                             raw<uint16_t>(1) + raw<uint8_t>(2) + raw(1.0f) + raw(2.0f) + raw<uint8_t>(9);
    std::string points;
    for (const float x : {0.0f, 1.0f, 2.0f, 3.0f}) points += raw(x) + raw(0.0f) + raw(0.0f) + raw(7.0f) + raw(2 * x);
    const PointCloud cloud =
        tetrahedra(kBinary +
                   "element tetrahedron 1\nproperty double quality\nproperty list int ushort vertex_index\n"
                   "property list uchar float weights\nelement edge 1\nproperty uchar a\nelement vertex 4\n" +
                   kXyz + "property float scale\nproperty float sigma_t\nend_header\n" + body + points);
    EXPECT_EQ(cloud.tetrahedra, (std::vector<glm::uvec4>{{0, 3, 2, 1}}));
    EXPECT_EQ(cloud.sigma_t, (std::vector<float>{0, 2, 4, 6}));
    EXPECT_TRUE(cloud.scale.empty()) << "corners have no size";
    EXPECT_EQ(cloud.ignored, std::vector<std::string>{"scale"});
}

TEST(Ply, PointsThatNoTetrahedronHasAreLeftOut) {
    const std::string vertices = "element vertex 7\n" + kXyz +
                                 "property float sigma_t\nproperty float red\nproperty float green\n"
                                 "property float blue\nproperty int id\n",
                      points = "0 0 0 0 0 0 0 10\n1 0 0 1 .1 0 0 11\n900 900 900 9 1 1 1 12\n0 1 0 2 .2 0 0 13\n"
                               "0 0 1 3 .3 0 0 14\n-900 0 0 9 1 1 1 15\n1 1 1 4 .4 0 0 16\n",
                      cells = "4 0 1 3 4\n4 6 4 3 1\n";
    for (const bool cells_first : {false, true}) {
        const PointCloud cloud =
            parsePly(cells_first ? fmt::format("{}{}{}end_header\n{}{}", kAscii, kCells, vertices, cells, points)
                                 : fmt::format("{}{}{}end_header\n{}{}", kAscii, vertices, kCells, points, cells),
                     "ply_test.ply", {}, {.ids = true, .tetrahedra = true});
        EXPECT_EQ(cloud.tetrahedra, (std::vector<glm::uvec4>{{0, 1, 2, 3}, {4, 3, 2, 1}}));
        EXPECT_EQ(cloud.position, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}));
        EXPECT_EQ(cloud.sigma_t, (std::vector<float>{0, 1, 2, 3, 4}));
        ASSERT_EQ(cloud.albedo.size(), 5u);
        EXPECT_EQ(cloud.albedo[4], glm::vec3(0.4f, 0, 0));
        EXPECT_EQ(cloud.id, (std::vector<int64_t>{10, 11, 13, 14, 16}));
        EXPECT_EQ(cloud.vertex, (std::vector<uint32_t>{0, 1, 3, 4, 6}));
        EXPECT_EQ(cloud.dropped, 2u);
        EXPECT_EQ(cloud.first_dropped, "vertex 2: no tetrahedron has it");
    }
    const PointCloud all = tetrahedra(kAscii + kCorners + kCells + "end_header\n" + kPoints + "4 0 1 2 3\n4 4 3 2 1\n");
    EXPECT_TRUE(all.dropped == 0 && all.vertex.empty() && all.first_dropped.empty());
}

TEST(Ply, HeaderSaysWhetherThereAreTetrahedra) {
    const std::string end = "end_header\n";
    EXPECT_TRUE(contentsOf(kAscii + kCorners + kCells + end, "ply_test.ply").tetrahedra);
    EXPECT_FALSE(contentsOf(kAscii + kCorners + end, "ply_test.ply").tetrahedra);
    EXPECT_FALSE(contentsOf(kAscii + kCorners + "element tetrahedron 0\n" + end, "ply_test.ply").tetrahedra);
    EXPECT_THROW(contentsOf(kAscii + kCorners, "ply_test.ply"), SceneError);
}

TEST(Ply, BrokenTetrahedraSayWhatIsExpected) {
    const std::string points = "end_header\n" + kPoints, head = kAscii + kCorners;
    const auto list = [](const char* property) { return std::string("element tetrahedron 2\nproperty ") + property; };
    const std::vector<Broken> all{
        {head + points, "no element tetrahedron; expected one with \"property list uchar int vertex_indices\""},
        {head + "element tetrahedron 0\n" + points, "element tetrahedron has 0 rows; allowed: 1 to 2000000"},
        {head + "element tetrahedron 2000001\n" + points, "2000001 rows; allowed: 1 to 2000000"},
        {head + list("list uchar int corners\n") + points, "element tetrahedron has no corners; expected \"prop"},
        {head + list("int vertex_indices\n") + points, "element tetrahedron has no corners"},
        {head + list("list uchar float vertex_indices\n") + points,
         "tetrahedron property vertex_indices is a list of type float; expected a whole-number type: \"property list "
         "uchar int vertex_indices\""},
        {head + list("list uchar float64 vertex_index\n") + points, "vertex_index is a list of type double; expected"},
        {head + list("list uchar int vertex_index\nproperty list uchar int vertex_index\n") + points,
         "tetrahedron property vertex_index is there twice"},
        {kAscii + "element vertex 1\n" + kXyz + "property float opacity\n" + kCells + "end_header\n0 0 0 1\n",
         "element vertex lacks sigma_t; expected the extinction at each corner of the tetrahedra, 1/m"},
        {kAscii + "element vertex 2\n" + kXyz + "property float sigma_t\n" + kCells +
             "end_header\n0 0 0 1\n0 nan 0 1\n",
         "a corner of tetrahedra cannot be left out: line 12: y is nan; allowed: finite"},
        {head + kCells + points + "4 0 1 2 3\n3 0 1 2\n", "tetrahedron, line 17: a list of 3 vertices; expected 4"},
        {head + kCells + points + "5 0 1 2 3 4\n", "line 16: a list of 5 vertices; expected 4"},
        {head + kCells + points + "4 0 1 2 5\n", "line 16: there is no vertex 5; expected 0 to 4"},
        {head + kCells + points + "4 0 1 2 -1\n", "line 16: there is no vertex -1; expected 0 to 4"},
        {head + kCells + points + "4 0 1 2 1.5\n", "line 16: there is no vertex 1.5; expected 0 to 4"},
        {head + kCells + points + "4 0 1 2 3\n", "ends early, after 1 of 2 rows of element tetrahedron"},
        {head + kCells + points + "4 0 1 2\n4 0 1 2 3\n", "16: PLY: the line has 4 values"},
    };
    for (const Broken& broken : all) {
        const std::string message = tetrahedraError(broken.bytes);
        EXPECT_NE(message.find(broken.says), std::string::npos)
            << "expected \"" << broken.says << "\", got: " << message;
        EXPECT_TRUE(message.starts_with("ply_test.ply:")) << message;
    }
}

TEST(Ply, IsReadFromAFile) {
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "ply_test.ply";
    std::ofstream(file, std::ios::binary)
        << kBinary + "element vertex 1\n" + kXyz + "end_header\n" + raw(1.0f) + raw(2.0f) + raw(3.0f);
    EXPECT_EQ(loadPly(file).position.at(0), glm::vec3(1, 2, 3));
}

TEST(Ply, PlacesCountFromTheOriginInDouble) {
    const std::string xyz = "element vertex 2\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    const std::string bytes =
        kBinary + xyz + raw(1000000.0009765625) + raw(-2e6) + raw(0.5) + raw(1e6) + raw(-1999999.75) + raw(7.0);
    const glm::dvec3 origin(1e6, -2e6, 0);
    const PointCloud cloud = parsePly(bytes, "ply_test.ply", {.origin = origin});
    ASSERT_EQ(cloud.position.size(), 2u);
    EXPECT_EQ(cloud.position[0], glm::vec3(0.0009765625f, 0, 0.5f));
    EXPECT_EQ(cloud.position[1], glm::vec3(0, 0.25f, 7));
    const PointCloud ascii =
        parsePly(kAscii + xyz + "1000000.0009765625 -2e6 .5\n0 0 0", "ply_test.ply", {.origin = origin});
    EXPECT_EQ(ascii.position, std::vector<glm::vec3>{cloud.position[0]})
        << "the point at the world's zero is too far away";
    EXPECT_EQ(ascii.dropped, 1u);
    EXPECT_NE(errorOf(bytes).find("origin"), std::string::npos) << errorOf(bytes); // without one, too far away
}

TEST(Ply, MissingFilesAndFoldersSaySo) {
    EXPECT_THROW(loadPly("no/such.ply"), SceneError);
    EXPECT_THROW(loadPly(testing::TempDir()), SceneError);
    EXPECT_THROW(loadPly("/dev/zero"), SceneError);
}

} // namespace
} // namespace brume::ply_test
