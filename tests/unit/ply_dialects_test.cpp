// Point clouds as many programs write them: each is read for what it means, and says what was guessed or left out.
#include <cmath>

#include "tests/unit/ply_reading.h"

namespace brume::ply_dialects_test {
namespace {

using test::asciiPly, test::expectFour, test::fourWith, test::kFour, test::kXyz, test::raw, test::replaced,
    test::swapped, test::tells;

PointCloud read(const std::string& bytes, PlyWanted wanted = {}) { return test::readPly(bytes, wanted); }
std::string refusal(const std::string& bytes) { return test::plyRefusal(bytes); }

TEST(PlyDialects, LinesEndInAnyWay) {
    const std::string plain = asciiPly("", kFour);
    for (const char* end : {"\n", "\r\n", "\r"}) expectFour(read(replaced(plain, "\n", end)));
    EXPECT_NE(refusal(replaced(asciiPly("", "0 0 0\n1 x 0\n"), "\n", "\r")).find("a.ply:9: "), std::string::npos)
        << "lines are counted, whatever ends them";
    const std::string body = raw(13.0f) + raw(10.0f) + raw(-1.0f); // no line ends, whatever their bytes are
    for (const char* end : {"\n", "\r\n", "\r"}) {
        const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + kXyz + "end_header\n";
        EXPECT_EQ(read(replaced(head, "\n", end) + body).position, (std::vector<glm::vec3>{{13, 10, -1}}));
    }
}

TEST(PlyDialects, WhatStandsAroundThePlyLineDoesNotMatter) {
    const std::string plain = asciiPly("", kFour);
    expectFour(read("\xef\xbb\xbf" + plain));
    expectFour(read("\xef\xbb\xbf" + replaced(plain, "\n", "\r")));
    expectFour(read(" " + plain));
    expectFour(read(replaced(plain, "ply\n", "ply \t\n")));
    expectFour(read(replaced(plain, "end_header", "end_header  ")));
    expectFour(read(replaced(plain, "ascii 1.0", "ascii 1.0 ")));
    EXPECT_NE(refusal("plyx" + plain).find("the first line is not \"ply\""), std::string::npos);
}

TEST(PlyDialects, BothByteOrdersAreRead) {
    const std::string head =
        "element vertex 2\nproperty double x\nproperty int y\nproperty short z\nproperty uchar "
        "red\nproperty uchar green\nproperty uchar blue\nproperty list ushort float w\nend_header\n";
    std::string little = "ply\nformat binary_little_endian 1.0\n" + head,
                big = "ply\nformat binary_big_endian 1.0\n" + head;
    const std::string colour = "\xff\x33" + std::string(1, '\0');
    for (const int i : {1, 300}) {
        little += raw(i + 0.5) + raw(-i) + raw(int16_t(i)) + colour + raw(uint16_t(2)) + raw(1.0f) + raw(2.0f);
        big += swapped(i + 0.5) + swapped(-i) + swapped(int16_t(i)) + colour + swapped(uint16_t(2)) + swapped(1.0f) +
               swapped(2.0f);
    }
    for (const std::string& bytes : {little, big}) {
        const PointCloud cloud = read(bytes);
        EXPECT_EQ(cloud.position, (std::vector<glm::vec3>{{1.5f, -1, 1}, {300.5f, -300, 300}}));
        EXPECT_EQ(cloud.albedo[1], glm::vec3(1, 0.2f, 0));
    }
}

TEST(PlyDialects, UnknownHeaderLinesAreToldAndPassedOver) {
    const PointCloud cloud =
        read(replaced(asciiPly("", kFour), "element vertex", "Created by  somebody\nelement vertex"));
    expectFour(cloud);
    EXPECT_TRUE(tells(cloud, "header line 3 is unknown and passed over: Created by somebody"));
    expectFour(read(replaced(asciiPly("", kFour), "element", "comment " + std::string(100'000, 'x') + "\nelement")));
    expectFour(read(replaced(asciiPly("", kFour), "element", "obj_info " + std::string(2000, '{') + "\nelement")));
    std::string many = asciiPly("", kFour);
    for (int i = 0; i < 9; ++i) many = replaced(many, "element", "x" + std::to_string(i) + "\nelement");
    EXPECT_EQ(read(many).notes.size(), 3u) << "the first few";
}

TEST(PlyDialects, HundredsOfPropertiesAndElementsAreRead) {
    std::string properties, values;
    for (int i = 0; i < 500; ++i) properties += "property float p_" + std::to_string(i) + "\n", values += "7 ";
    const PointCloud cloud = read(fourWith(properties, values));
    expectFour(cloud);
    EXPECT_EQ(cloud.ignored.size(), 500u);
    std::string elements;
    for (int i = 0; i < 100; ++i) elements += "element e_" + std::to_string(i) + " 0\nproperty float a\n";
    const PointCloud beside = read(replaced(asciiPly("", kFour), "end_header", elements + "end_header"));
    expectFour(beside);
    EXPECT_TRUE(beside.notes.empty()) << "elements without rows go without saying";
}

TEST(PlyDialects, ElementsThatAreNotReadAreTold) {
    const std::string face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const PointCloud mesh = read(replaced(asciiPly("", kFour), "end_header\n", face) + "3 0 1 2\n");
    expectFour(mesh);
    EXPECT_TRUE(tells(mesh, "element face, 1 row, is ignored"));
    EXPECT_TRUE(
        tells(read(replaced(asciiPly("", kFour), "end_header\n", "element edge 2\nproperty int a\nend_header\n")),
              "element edge, 2 rows, is ignored"));
    const std::string cells = "element tetrahedron 1\nproperty list uchar int indices\nproperty float s\nend_header\n";
    EXPECT_TRUE(tells(read(replaced(asciiPly("", kFour), "end_header\n", cells) + "4 0 1 2 3 0.5\n"),
                      "element tetrahedron, 1 row, is ignored; medium.model = \"tetrahedra\" reads it"));
    EXPECT_NE(refusal(replaced(asciiPly("", kFour), "end_header", "element vertex 3\nproperty float x\nend_header"))
                  .find("element vertex is there twice"),
              std::string::npos);
}

TEST(PlyDialects, AllTypesOfNumbersArePassedOver) {
    for (const char* type : {"bool", "char", "uchar", "short", "ushort", "int", "uint", "int64", "uint64", "long",
                             "float", "double", "uint8", "float64"}) {
        const PointCloud cloud = read(fourWith(std::string("property ") + type + " other\n", "1"));
        expectFour(cloud);
        EXPECT_EQ(cloud.ignored, std::vector<std::string>{"other"}) << type;
    }
    const std::string head =
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty int64 gps\nproperty bool in\n" + kXyz;
    EXPECT_EQ(read(head + "end_header\n" + raw(int64_t(1) << 40) + "\1" + raw(1.0f) + raw(2.0f) + raw(3.0f)).position,
              (std::vector<glm::vec3>{{1, 2, 3}}));
    EXPECT_NE(refusal(fourWith("property quaternion turn\n", "1")).find("property turn has an unknown type"),
              std::string::npos)
        << "the property is named";
}

// Colours of one type and the same numbers for all points, and what they mean.
struct Coloured {
    const char *type, *names, *values;
    glm::vec3 albedo;
    const char* told; // part of a note; empty: none
};

TEST(PlyDialects, ColoursOfAnyTypeAndRangeAreRead) {
    const Coloured all[]{
        {"ushort",
         "red green blue",
         "65535 32768 16384",
         {1, 32768 / 65535.0f, 16384 / 65535.0f},
         "65535 stands for 1"},
        {"ushort", "red green blue", "255 51 0", {1, 0.2f, 0}, "255 stands for 1"},
        {"int", "red green blue", "255 127 63", {1, 127 / 255.0f, 63 / 255.0f}, "255 stands for 1"},
        {"short", "diffuse_red diffuse_green diffuse_blue", "51 0 255", {0.2f, 0, 1}, "255 stands for 1"},
        {"uint", "red green blue", "65535 0 13107", {1, 0, 0.2f}, "65535 stands for 1"},
        {"char", "red green blue", "64 -1 0", {64 / 255.0f, 1, 0}, "255 stands for 1"},
        {"uchar", "r g b", "255 51 0", {1, 0.2f, 0}, ""},
        {"uchar", "red green blue", "64 64 64", glm::vec3(64 / 255.0f), ""},
        {"float", "red green blue", "0.25 0.5 1", {0.25f, 0.5f, 1}, ""},
        {"float", "red green blue", "255 128 64", {1, 128 / 255.0f, 64 / 255.0f}, "255 stands for 1"},
        {"double", "r g b", "65535 0 13107", {1, 0, 0.2f}, "65535 stands for 1"},
        {"float", "red green blue", "1.25 0.5 0", {1, 0.5f, 0}, "what is above 1 counts as 1"},
    };
    for (const Coloured& one : all) {
        std::string properties = replaced(std::string(one.names) + " ", " ", "\n"), typed;
        for (size_t at = 0, end; (end = properties.find('\n', at)) != properties.npos; at = end + 1)
            typed += std::string("property ") + one.type + " " + properties.substr(at, end + 1 - at);
        const PointCloud cloud = read(fourWith(typed, one.values));
        expectFour(cloud);
        ASSERT_EQ(cloud.albedo.size(), 4u) << one.type << ' ' << one.values;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(cloud.albedo[3][c], one.albedo[c], 1e-6f) << one.type << ' ' << one.values;
        EXPECT_EQ(!cloud.notes.empty(), *one.told != 0) << one.type << ' ' << one.values;
        EXPECT_TRUE(tells(cloud, one.told) || !*one.told) << one.type << ' ' << one.values;
    }
}

TEST(PlyDialects, SomeOfTheColoursAreNone) {
    for (const char* missing : {"red", "green", "blue"}) {
        std::string properties;
        for (const char* name : {"red", "green", "blue"})
            if (name != std::string(missing)) properties += std::string("property uchar ") + name + "\n";
        const PointCloud cloud = read(fourWith(properties, "1 2"));
        expectFour(cloud);
        EXPECT_TRUE(cloud.albedo.empty());
        EXPECT_TRUE(tells(cloud, "colours are not read"));
    }
    EXPECT_TRUE(read(fourWith("property uchar red\n", "9")).albedo.empty());
}

TEST(PlyDialects, OpacitiesOfAnyTypeAreRead) {
    EXPECT_NEAR(read(fourWith("property ushort opacity\n", "32768")).opacity[0], 0.50001f, 1e-5f);
    EXPECT_NEAR(read(fourWith("property uchar opacity\n", "128")).opacity[0], 128 / 255.0f, 1e-6f);
    EXPECT_NEAR(read(fourWith("property float opacity\n", "0.25")).opacity[0], 0.25f, 1e-6f);
    EXPECT_NEAR(read(fourWith("property float opacity\n", "51")).opacity[0], 0.2f, 1e-6f);
    EXPECT_EQ(read(asciiPly("property float opacity\n", "0 0 0 -1\n1 0 0 0.5\n")).dropped, 1u);
}

TEST(PlyDialects, WhatIsNoNumberIsDroppedWhateverItIsCalled) {
    for (const char* word : {"nan", "-nan", "inf", "-inf", "-1.#IND", "1.#QNAN", "1.#INF", "-1.#INF00", "1e999"}) {
        const PointCloud cloud = read(asciiPly("", "0 0 0\n1 0 0\n0 2 0\n0 0 " + std::string(word) + "\n"));
        EXPECT_EQ(cloud.position.size(), 3u) << word;
        EXPECT_EQ(cloud.dropped, 1u) << word;
        EXPECT_EQ(cloud.first_dropped.find("line 11: z is "), 0u) << cloud.first_dropped;
    }
    for (const char* word : {"2.#IND", "1.5#INF", "x1.#INF"})
        EXPECT_NE(refusal(asciiPly("", "0 0 " + std::string(word) + "\n")).find("is not a number"), std::string::npos);
}

TEST(PlyDialects, AFileWithoutPointsIsAnErrorOrAMoment) {
    EXPECT_NE(refusal(asciiPly("", "")).find("element vertex has 0 points"), std::string::npos);
    EXPECT_TRUE(read(asciiPly("", ""), {.may_be_empty = true}).position.empty());
}

TEST(PlyDialects, TetrahedraMayHaveTheirOwnExtinction) {
    const std::string cells = "element tetrahedron 2\nproperty list uchar int indices\nproperty float s\nend_header\n";
    const PointCloud cloud =
        read(replaced(asciiPly("", kFour + "1 1 1\n"), "end_header\n", cells) + "4 0 1 2 3 0.5\n4 4 1 2 3 2\n",
             {.tetrahedra = true});
    ASSERT_EQ(cloud.tetrahedra.size(), 2u);
    EXPECT_EQ(cloud.sigma_t[0], 0.5f);
    EXPECT_EQ(cloud.sigma_t[4], 2);
    // Volumes 6/6 and |(a - d) . ((b - d) x (c - d))| / 6 = 5/6.
    EXPECT_NEAR(cloud.sigma_t[1], (6 * 0.5 + 5 * 2) / 11, 1e-6);
    EXPECT_TRUE(tells(cloud, "the mean extinction of its tetrahedra"));
}

const glm::dvec3 kUtm(700000, 5300001, 401);

std::string utm(const char* type) {
    const std::string properties = replaced(kXyz, "float", type);
    return "ply\nformat ascii 1.0\nelement vertex 4\n" + properties +
           "end_header\n700000 5300000 400\n700001 5300000 400\n700000 5300002 400\n700000 5300000 403\n";
}

// Headers as programs write them, and one row of each.
TEST(PlyDialects, FilesInTheFormOfManyProgramsAreRead) {
    const std::string binary = "ply\nformat binary_little_endian 1.0\n", place = raw(1.0f) + raw(2.0f) + raw(3.0f);
    const std::string colours = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    const std::string blender = binary + "comment Created by Blender 3.4.1 - www.blender.org\nelement vertex 1\n" +
                                kXyz + "property float nx\nproperty float ny\nproperty float nz\n" + colours +
                                "property uchar alpha\nelement face 0\nproperty list uchar uint vertex_indices\n"
                                "end_header\n" +
                                place + place + "\xff\x33\x66\xff";
    const std::string paraview = binary +
                                 "comment VTK generated PLY File\nobj_info vtkPolyData points and polygons: "
                                 "vtk4.0\nelement vertex 1\n" +
                                 kXyz + colours +
                                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + place +
                                 "\xff\x33\x66" + raw(uint8_t(1)) + raw(0);
    const std::string pdal = binary +
                             "comment Generated by PDAL\nelement vertex 1\nproperty float64 x\n"
                             "property float64 y\nproperty float64 z\nproperty uint16 intensity\n"
                             "property uint16 red\nproperty uint16 green\nproperty uint16 blue\nend_header\n" +
                             raw(1.0) + raw(2.0) + raw(3.0) + raw(uint16_t(9)) + raw(uint16_t(65535)) +
                             raw(uint16_t(13107)) + raw(uint16_t(26214));
    const std::string cloud_compare = "ply\nformat ascii 1.0\ncomment Created by CloudCompare v2.12\n"
                                      "comment Created 1/1/26\nobj_info Generated by CloudCompare!\nelement vertex 1\n"
                                      "property double x\nproperty double y\nproperty double z\n" +
                                      colours + "property float scalar_Intensity\nend_header\n1 2 3 255 51 102 0.5 \n";
    for (const std::string& bytes : {blender, paraview, pdal, cloud_compare}) {
        const PointCloud cloud = read(bytes);
        ASSERT_EQ(cloud.position, (std::vector<glm::vec3>{{1, 2, 3}})) << bytes.substr(0, 80);
        EXPECT_NEAR(cloud.albedo.at(0).y, 0.2f, 1e-6f) << bytes.substr(0, 80);
        EXPECT_NEAR(cloud.albedo.at(0).z, 0.4f, 1e-6f) << bytes.substr(0, 80);
    }
}

TEST(PlyDialects, WherePointsAreIsKnownBeforeTheyAreRead) {
    for (const char* type : {"double", "float"}) {
        const PlyExtent extent = extentOf(utm(type), "a.ply", "y");
        const glm::dvec3 origin = originFor(extent, 1);
        EXPECT_LT(glm::distance(origin, kUtm), 3) << "in whole metres near the points";
        EXPECT_EQ(origin, glm::round(origin));
        const PointCloud cloud = parsePly(utm(type), "a.ply", {.origin = origin});
        ASSERT_EQ(cloud.position.size(), 4u);
        EXPECT_EQ(glm::dvec3(cloud.position[3] - cloud.position[0]), glm::dvec3(0, 0, 3));
        EXPECT_EQ(glm::dvec3(cloud.position[1]) + origin, glm::dvec3(700001, 5300000, 400));
    }
    EXPECT_EQ(originFor(extentOf(asciiPly("", kFour), "a.ply", "y"), 1), glm::dvec3(0)) << "near enough";
    EXPECT_THROW(originFor(extentOf(utm("double"), "a.ply", "y"), 1000), SceneError)
        << "farther than the Earth is wide";
    EXPECT_NE(refusal(utm("double")).find("origin = \"auto\""), std::string::npos);
}

TEST(PlyDialects, UnitAndAxisAreTheCallers) {
    const std::string bytes = fourWith("property float scale\nproperty float sigma_t\n", "4 0.5");
    const PointCloud cloud = parsePly(bytes, "a.ply", {.origin = {0, 0, 1}, .unit = 0.01, .up = "z"});
    EXPECT_EQ(cloud.position[1], glm::vec3(0.01f, 0, -1));
    EXPECT_EQ(cloud.position[2], glm::vec3(0, 0, -1.02f)) << "y goes away from the viewer";
    EXPECT_EQ(cloud.position[3], glm::vec3(0, 0.03f, -1)) << "z goes up";
    EXPECT_EQ(cloud.scale[0], 0.04f);
    EXPECT_EQ(cloud.sigma_t[0], 50) << "per unit: what is seen stays";
    const auto third = [&](const char* up) { return parsePly(bytes, "a.ply", {.unit = 1, .up = up}).position[2]; };
    EXPECT_EQ(third("y"), glm::vec3(0, 2, 0));
    EXPECT_EQ(third("-y"), glm::vec3(0, -2, 0));
    EXPECT_EQ(third("x"), glm::vec3(-2, 0, 0));
}

// 125 points of a cube of 4 m, and others.
std::string cubeAnd(const std::string& others) {
    std::string points;
    for (int i = 0; i < 125; ++i)
        points += std::to_string(i % 5) + ' ' + std::to_string(i / 5 % 5) + ' ' + std::to_string(i / 25) + '\n';
    return asciiPly("", points + others);
}

TEST(PlyDialects, PointsFarFromAllOthersAreTold) {
    for (const auto& [place, text] : {std::pair("40000 0 0\n", "1 point is 40 km from the others"),
                                      {"0 2000 0\n", "1 point is 1998 m from the others"},
                                      {"0 -300 0\n0 0 900\n", "2 points are up to 898 m from the others"}}) {
        const PointCloud kept = read(cubeAnd(place)), dropped = read(cubeAnd(place), {.drop_far = true});
        EXPECT_TRUE(tells(kept, text)) << text;
        EXPECT_GT(kept.position.size(), 125u);
        EXPECT_TRUE(tells(dropped, std::string(text) + " and left out")) << text;
        EXPECT_EQ(dropped.position.size(), 125u);
    }
    EXPECT_TRUE(read(cubeAnd("30 0 0\n")).notes.empty()) << "not so far";
    EXPECT_TRUE(read(cubeAnd("900 0 0\n901 0 0\n902 0 0\n903 0 0\n")).notes.empty()) << "not so few";
    EXPECT_TRUE(read(asciiPly("", kFour + "0 0 40000\n")).notes.empty()) << "of five none is the others";
    EXPECT_EQ(extentOf(cubeAnd("40000 0 0\n"), "a.ply", "y").middle, glm::dvec3(2));
}

} // namespace
} // namespace brume::ply_dialects_test
