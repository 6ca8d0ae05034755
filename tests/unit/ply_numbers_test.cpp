// Numbers of PLY files at their limits: colours and opacities of any type, words that are no numbers, and splats.
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "tests/unit/ply_reading.h"

namespace brume::ply_numbers_test {
namespace {

using test::asciiPly, test::expectFour, test::expectPlyRefused, test::fourWith, test::kXyz, test::raw, test::readPly,
    test::replaced, test::swapped, test::tells;

// Properties of three channels, "uchar red, ushort green, float b"; the same values for all points, and what they mean.
struct Channels {
    const char *properties, *values;
    glm::vec3 albedo;
    const char* told; // the one note; empty: none
};

std::string propertiesOf(const std::string& list) { return "property " + replaced(list, ", ", "\nproperty ") + "\n"; }

TEST(PlyNumbers, ColoursAreReadFromTypesAtTheirLimits) {
    const std::string rgb[]{"short red, short green, short blue", "int red, int green, int blue",
                            "uint red, uint green, uint blue", "float red, float green, float blue",
                            "uint16 r, uint16 g, uint16 b"};
    const Channels all[]{
        // A program whose 16 bits have a sign writes what is above 32767 as a negative number.
        {rgb[0].c_str(),
         "-1 -32768 16384",
         {1, 32768 / 65535.0f, 16384 / 65535.0f},
         "colours reach 65535: 65535 stands for 1"},
        {rgb[0].c_str(), "255 0 51", {1, 0, 0.2f}, "colours reach 255: 255 stands for 1"},
        {rgb[1].c_str(), "65535 256 0", {1, 256 / 65535.0f, 0}, "colours reach 65535: 65535 stands for 1"},
        {rgb[1].c_str(), "2147483647 1073741824 0", {1, 0.5f, 0}, "2147483647 stands for 1"},
        {rgb[2].c_str(), "4294967295 2147483648 0", {1, 0.5f, 0}, "4294967295 stands for 1"},
        {rgb[3].c_str(), "1.9999 1 0", {1, 1, 0}, "colours reach 1.9999: what is above 1 counts as 1"},
        {rgb[3].c_str(), "2 51 0", {2 / 255.0f, 0.2f, 0}, "colours reach 51: 255 stands for 1"},
        {rgb[3].c_str(), "0 0 1e-30", {0, 0, 0}, ""},
        {rgb[4].c_str(), "65535 1 13107", {1, 1 / 65535.0f, 0.2f}, "65535 stands for 1"},
        // Each channel counts by its own type.
        {"uchar red, ushort green, float blue", "255 13107 0.25", {1, 0.2f, 0.25f}, "65535 stands for 1"},
        {"float red, uchar green, uchar blue", "1 255 51", {1, 1, 0.2f}, ""},
        {"uchar blue, ushort red, ushort green", "51 65535 0", {1, 0, 0.2f}, "65535 stands for 1"},
        {"uint8 diffuse_red, int8 diffuse_green, float32 diffuse_blue", "255 -1 0.5", {1, 1, 0.5f}, "255 stands for 1"},
        {"uchar r, uchar diffuse_green, uchar b", "255 51 0", {1, 0.2f, 0}, ""},
    };
    for (const Channels& one : all) {
        const PointCloud cloud = readPly(fourWith(propertiesOf(one.properties), one.values));
        const std::string of = std::string(one.properties) + ": " + one.values;
        expectFour(cloud, of);
        ASSERT_EQ(cloud.albedo.size(), 4u) << of;
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(cloud.albedo[0][c], one.albedo[c], 1e-6f) << of;
        EXPECT_EQ(cloud.notes.size(), *one.told ? 1u : 0u) << of << testing::PrintToString(cloud.notes);
        EXPECT_TRUE(tells(cloud, one.told) || !*one.told) << of << testing::PrintToString(cloud.notes);
    }
}

// The range is that of all points, whatever a point alone would say, and whichever of them are dropped.
TEST(PlyNumbers, TheRangeOfColoursIsThatOfTheFile) {
    const std::string rgb = propertiesOf("float red, float green, float blue");
    const PointCloud cloud = readPly(asciiPly(rgb, "0 0 0 1 0 0\n1 0 0 0 255 0\n2 0 0 nan 0 0\n3 0 0 -9 0 0\n"));
    ASSERT_EQ(cloud.albedo.size(), 2u);
    EXPECT_NEAR(cloud.albedo[0].x, 1 / 255.0f, 1e-7f);
    EXPECT_EQ(cloud.albedo[1], glm::vec3(0, 1, 0));
    EXPECT_EQ(cloud.dropped, 2u);
    EXPECT_EQ(cloud.first_dropped.find("line 13: red is nan; allowed: 0 to "), 0u) << cloud.first_dropped;
    for (const auto& [type, value, allowed] :
         {std::tuple("int", "-1", "0 to 255"), {"float", "-9", "0 to 255"}, {"ushort", "-5", "0 to 65535"}}) {
        const std::string properties = propertiesOf(replaced("T red, T green, T blue", "T", type));
        const std::string full = std::string(allowed).substr(5);
        const PointCloud one = readPly(asciiPly(properties, "0 0 0 " + full + " 0 0\n1 0 0 0 " + value + " 0\n"));
        EXPECT_EQ(one.first_dropped, "line 12: green is " + std::string(value) + "; allowed: " + allowed) << type;
    }
    const std::string head = "element vertex 1\n" + kXyz + propertiesOf("ushort red, ushort green, ushort blue");
    const std::string little = "ply\nformat binary_little_endian 1.0\n" + head + "end_header\n" + raw(1.0f) +
                               raw(2.0f) + raw(3.0f) + raw(uint16_t(65535)) + raw(uint16_t(255)) + raw(uint16_t(32768));
    const std::string big = "ply\nformat binary_big_endian 1.0\n" + head + "end_header\n" + swapped(1.0f) +
                            swapped(2.0f) + swapped(3.0f) + swapped(uint16_t(65535)) + swapped(uint16_t(255)) +
                            swapped(uint16_t(32768));
    for (const std::string& bytes : {little, big})
        EXPECT_EQ(readPly(bytes).albedo, (std::vector<glm::vec3>{{1, 255 / 65535.0f, 32768 / 65535.0f}}));
}

TEST(PlyNumbers, SomeChannelsOfAnyNamesAndTypesAreNoColours) {
    for (const char* list :
         {"uchar red", "ushort green, ushort blue", "float r", "uchar r, uchar b", "int diffuse_red",
          "uchar red, uchar r", "uchar diffuse_green, uchar alpha", "uchar red, uchar blue, uchar bleu"}) {
        const std::string properties = propertiesOf(list);
        std::string values;
        for (const char c : properties) values += c == '\n' ? "9 " : "";
        const PointCloud cloud = readPly(fourWith(properties, values));
        expectFour(cloud, list);
        EXPECT_TRUE(cloud.albedo.empty()) << list;
        EXPECT_EQ(cloud.notes,
                  std::vector<std::string>{"of red, green and blue some are missing: colours are not read"})
            << list;
        EXPECT_EQ(ptrdiff_t(cloud.ignored.size()), std::ranges::count(properties, '\n')) << list;
    }
    // With other properties that are read.
    const PointCloud cloud = readPly(fourWith(propertiesOf("uchar red, float scale, uchar opacity"), "9 2 51"));
    EXPECT_TRUE(cloud.albedo.empty());
    EXPECT_EQ(cloud.scale, std::vector<float>(4, 2));
    EXPECT_EQ(cloud.opacity, std::vector<float>(4, 0.2f));
}

TEST(PlyNumbers, OpacitiesAreReadFromTypesAtTheirLimits) {
    struct Opacity {
        const char *type, *value;
        float opacity;
        const char* told;
    };
    for (const auto& [type, value, opacity, told] : std::initializer_list<Opacity>{
             {"ushort", "65535", 1, "opacities reach 65535: 65535 stands for 1"},
             {"ushort", "32768", 32768 / 65535.0f, "opacities reach 32768: 65535 stands for 1"},
             {"ushort", "255", 1, "opacities reach 255: 255 stands for 1"},
             {"short", "-32768", 32768 / 65535.0f, "65535 stands for 1"},
             {"char", "-1", 1, "255 stands for 1"},
             {"int", "51", 0.2f, "255 stands for 1"},
             {"uint", "4294967295", 1, "4294967295 stands for 1"},
             {"uchar", "1", 1 / 255.0f, ""},
             {"double", "1", 1, ""},
             {"float", "1.5", 1, "what is above 1 counts as 1"},
             {"float", "0", 0, ""}}) {
        const PointCloud cloud = readPly(fourWith("property " + std::string(type) + " opacity\n", value));
        expectFour(cloud, type);
        for (const float got : cloud.opacity) EXPECT_NEAR(got, opacity, 1e-6f) << type << ' ' << value;
        EXPECT_TRUE(*told ? tells(cloud, told) : cloud.notes.empty()) << type << ' ' << value;
    }
}

// Words of many programs, in any property that is read; what is too small for a double is nothing.
TEST(PlyNumbers, WordsThatAreNoFiniteNumber) {
    for (const char* word :
         {"NaN", "NAN", "+nan", "-nan(ind)", "nan(snan)", "-1.#IND00", "+1.#QNAN0", "1.#SNAN", "1.#J", "INF", "+inf",
          "Infinity", "-INFINITY", "1.#INF000", "+1.#INF", "1e400", "-1E+400"}) {
        const PointCloud cloud =
            readPly(asciiPly("property float scale\n", "0 0 0 1\n1 0 0 2\n0 2 0 " + std::string(word) + "\n"));
        EXPECT_EQ(cloud.position.size(), 2u) << word;
        EXPECT_EQ(cloud.dropped, 1u) << word;
        EXPECT_EQ(cloud.first_dropped.find("line 11: scale is "), 0u) << cloud.first_dropped;
        expectFour(readPly(fourWith("property float not_read\n", word)), word);
    }
    for (const char* word : {"1e-400", "-1e-5000", "+2.5E-999", "0e-999", "0.000e999", "-0", "1e-320"}) {
        const PointCloud cloud = readPly(asciiPly("", "1 0 " + std::string(word) + "\n"));
        EXPECT_EQ(cloud.position, (std::vector<glm::vec3>{{1, 0, 0}})) << word;
        EXPECT_EQ(cloud.dropped, 0u) << word;
    }
    for (const char* word : {"nanx", "infin", "2.#INF", "--1", "0x10", "1e", "1.2.3", "N/A"})
        expectPlyRefused(asciiPly("", "1 0 " + std::string(word) + "\n"),
                         "a.ply:8: PLY: property z: \"" + std::string(word) + "\" is not a number");
}

const std::string kSplat =
    propertiesOf("float f_dc_0, float f_dc_1, float f_dc_2, float opacity, float scale_0, "
                 "float scale_1, float scale_2, float rot_0, float rot_1, float rot_2, float rot_3");

// Logits and logarithms at which exponentials overflow.
TEST(PlyNumbers, SplatsOfExtremeNumbersAreReadOrDroppedAlone) {
    struct Logit {
        const char* logit;
        float opacity;
    };
    for (const auto& [logit, opacity] : std::initializer_list<Logit>{{"2.5", 0.924142f},
                                                                     {"0", 0.5f},
                                                                     {"-1.0", 0.268941f},
                                                                     {"800", 1},
                                                                     {"-800", 0},
                                                                     {"1e30", 1},
                                                                     {"-1e30", 0}}) {
        const PointCloud cloud = readPly(fourWith(kSplat, "0 0 0 " + std::string(logit) + " -1 -1 -1 1 0 0 0"));
        expectFour(cloud, logit);
        for (const float got : cloud.opacity) EXPECT_NEAR(got, opacity, 1e-6f) << logit;
        for (const float got : cloud.deviation) EXPECT_NEAR(got, 0.367879f, 1e-6f);
    }
    const PointCloud cloud = readPly(asciiPly(
        kSplat, "0 0 0 1e30 -1e30 0 2 -1 -1 -1 1 0 0 0\n1 0 0 0 0 0 2 800 800 800 1 0 0 0\n" // as large as nothing
                "2 0 0 0 0 0 2 -800 -800 -800 1 0 0 0\n3 0 0 inf 0 0 2 -1 -1 -1 1 0 0 0\n"
                "4 0 0 nan 0 0 2 -1 -1 -1 1 0 0 0\n5 0 0 0 0 0 2 -1 -1 -1 nan 0 0 0\n"));
    EXPECT_EQ(cloud.dropped, 2u) << cloud.first_dropped;
    ASSERT_EQ(cloud.position.size(), 4u);
    EXPECT_EQ(cloud.first_dropped.find("line 20: size is "), 0u) << cloud.first_dropped;
    EXPECT_EQ(cloud.albedo[0], glm::vec3(1, 0, 0.5f));
    EXPECT_EQ(cloud.deviation[1], 0);
    EXPECT_EQ(cloud.albedo[2], glm::vec3(1, 0.5f, 0.5f)) << "infinitely bright";
}

TEST(PlyNumbers, SplatsThatLackSomethingSayWhat) {
    for (const char* missing : {"f_dc_1", "f_dc_2", "y", "z"})
        expectPlyRefused(
            replaced(fourWith(kSplat, "0 0 0 2 -1 -1 -1 1 0 0 0"), std::string(" ") + missing + "\n", " other\n"),
            "element vertex has properties of Gaussian splatting, but no " + std::string(missing));
    // Those of an axis that is missing are the one's before it, and a splat without a rotation has none.
    for (const char* missing : {"scale_2", "rot_0", "rot_3"})
        expectFour(readPly(replaced(fourWith(kSplat, "0 0 0 2 -1 -1 -1 1 0 0 0"), missing, "other")), missing);
    EXPECT_EQ(readPly(replaced(fourWith(kSplat, "0 0 0 2 -1 -1 -1 1 0 0 0"), "float ", "double ")).opacity.size(), 4u);
}

// What is beside packed splats, as the harmonics of their colours, is told.
TEST(PlyNumbers, WhatIsBesidePackedSplatsIsTold) {
    std::string head = "ply\nformat binary_little_endian 1.0\nelement chunk 1\n", chunk;
    for (const char* name : {"x", "y", "z", "scale_x", "scale_y", "scale_z"})
        for (const char* end : {"min_", "max_"}) head += "property float " + std::string(end) + name + "\n";
    for (const float x : {0.0f, 1.0f, 0.0f, 2.0f, 0.0f, 3.0f, -1.0f, 0.0f, -1.0f, 0.0f, -1.0f, 0.0f}) chunk += raw(x);
    head += "element vertex 1\n" + propertiesOf("uint packed_position, uint packed_rotation, uint packed_scale, uint "
                                                "packed_color, ushort segment");
    const std::string row = raw(~0u) + raw(0u) + raw(0u) + raw(0xff8000ffu) + raw(uint16_t(7));
    const PointCloud cloud = readPly(head + "element sh 1\n" + propertiesOf("uchar f_rest_0, uchar f_rest_1") +
                                     "end_header\n" + chunk + row + "ab");
    EXPECT_EQ(cloud.position, (std::vector<glm::vec3>{{1, 2, 3}}));
    EXPECT_NEAR(cloud.deviation.at(0), std::exp(-1.0f), 1e-6f);
    EXPECT_EQ(cloud.opacity, std::vector<float>{1});
    EXPECT_TRUE(tells(cloud, "element sh, 1 row, is ignored")) << testing::PrintToString(cloud.notes);
    EXPECT_EQ(cloud.ignored, std::vector<std::string>{"segment"});
    for (const char* lacking : {"packed_scale", "packed_color"})
        expectPlyRefused(fmt::format("{}end_header\n{}{}", replaced(head, lacking, "other"), chunk, row),
                         fmt::format("packed Gaussian splats (element chunk, packed_position) without {}", lacking));
    expectPlyRefused(replaced(head, "max_scale_y", "other") + "end_header\n" + chunk + row,
                     "without min_scale_y and max_scale_y; write them unpacked");
}

} // namespace
} // namespace brume::ply_numbers_test
