// Headers of PLY files at their limits: line ends, marks, comments, types, and things that are there twice.
#include <limits>

#include <fmt/format.h>

#include "tests/unit/ply_reading.h"

namespace brume::ply_headers_test {
namespace {

using test::asciiPly, test::expectFour, test::expectPlyRefused, test::fourWith, test::kFour, test::kXyz, test::raw,
    test::readPly, test::replaced, test::tells;

const std::string kBinary = "ply\nformat binary_little_endian 1.0\n", kBom = "\xef\xbb\xbf";
const std::string kPlace = raw(1.0f) + raw(2.0f) + raw(3.0f);

// Bytes that would end lines, at the very beginning of a body.
TEST(PlyHeaders, LineEndsInABinaryBodyAreNumbers) {
    const std::string head = kBinary + "element vertex 1\nproperty uchar a\nproperty uchar b\n" + kXyz + "end_header\n";
    for (const char* end : {"\n", "\r\n", "\r"})
        for (const char* first : {"\n\n", "\r\n", "\n\r", "\r\r", " \t"})
            for (const char* mark : {"", kBom.c_str()})
                EXPECT_EQ(readPly(mark + replaced(head, "\n", end) + first + kPlace).position,
                          (std::vector<glm::vec3>{{1, 2, 3}}));
}

TEST(PlyHeaders, LinesOfDifferentEndsAreReadInOneFile) {
    const std::string plain = asciiPly("", kFour), body = kFour, head = plain.substr(0, plain.size() - body.size());
    expectFour(readPly(replaced(head, "\n", "\r\n") + body), "a header of another program");
    expectFour(readPly(head + replaced(body, "\n", "\r\n")));
    expectFour(readPly("ply\r\n" + plain.substr(4)));
    expectFour(readPly("ply\n" + replaced(plain.substr(4), "\n", "\r\n")));
    for (const char* end : {"\n", "\r\n", "\r"}) {
        expectFour(readPly(replaced(replaced(plain, "\n", "\n\n \t\n"), "\n", end)), "blank lines");
        expectFour(readPly(replaced(plain.substr(0, plain.size() - 1), "\n", end)), "no end of the last line");
        expectPlyRefused(replaced(head + "\n\n0 0 0\n\n1 x 0\n", "\n", end), "a.ply:12: ");
    }
}

TEST(PlyHeaders, AByteOrderMarkIsNoWord) {
    for (const char* end : {"\n", "\r\n", "\r"}) expectFour(readPly(kBom + replaced(asciiPly("", kFour), "\n", end)));
    EXPECT_EQ(readPly(kBom + kBinary + "element vertex 1\n" + kXyz + "end_header\n" + kPlace).position.size(), 1u);
    expectPlyRefused(kBom, "ends inside its header");
    std::string little = "\xff\xfe", big = "\xfe\xff";
    for (const char c : asciiPly("", kFour)) little += {c, '\0'}, big += {'\0', c};
    for (const std::string& wide : {little, big})
        expectPlyRefused(wide, "a.ply: PLY: text of two bytes a character (UTF-16); save it as ASCII or UTF-8");
}

TEST(PlyHeaders, CommentsMayBeLongWhereverTheyAre) {
    for (const char* end : {"\n", "\r\n", "\r"})
        for (const char* word : {"comment", "obj_info", " comment", "\tobj_info"})
            for (const size_t length : {1016u, 1017u, 1025u, 500'000u}) {
                const std::string line = std::string(word) + ' ' + std::string(length, 'x') + '\n';
                for (const char* before : {"format", "element", "property float y", "end_header"})
                    expectFour(readPly(replaced(replaced(asciiPly("", kFour), before, line + before), "\n", end)));
            }
    expectPlyRefused(replaced(asciiPly("", kFour), "element", "commented" + std::string(1025, 'x') + "\nelement"),
                     "a.ply:3: PLY: a header line is longer than 1024 bytes; expected a PLY file, whose comments");
    const std::string plain = asciiPly("", kFour);
    const size_t rest = (1 << 20) - (plain.size() - kFour.size()); // as many bytes as the header may still have
    for (const auto& [length, is_read] : {std::pair(rest - 9, true), {rest + 9, false}}) {
        const std::string bytes = replaced(plain, "element", "comment " + std::string(length, 'x') + "\nelement");
        if (is_read)
            expectFour(readPly(bytes));
        else
            expectPlyRefused(bytes, "the header is longer than 1 MiB; is end_header missing?");
    }
}

TEST(PlyHeaders, UnknownLinesAreToldWhereverTheyAre) {
    for (const char* before : {"format", "element", "property float y", "end_header"})
        for (const char* line : {"VERSION", "\tVERSION\t", "x 1 2 3 4 5 6", "Comment by hand", "end_headers"}) {
            const PointCloud cloud = readPly(replaced(asciiPly("", kFour), before, std::string(line) + '\n' + before));
            expectFour(cloud, line);
            EXPECT_EQ(cloud.notes.size(), 1u) << line;
            EXPECT_TRUE(tells(cloud, " is unknown and passed over: ")) << line;
        }
    const std::string hostile = "x\x1b[2J\x07 " + std::string(900, 'y');
    const PointCloud cloud = readPly(replaced(asciiPly("", kFour), "element", hostile + "\nelement"));
    EXPECT_EQ(cloud.notes.at(0), "header line 3 is unknown and passed over: x?[2J? " + std::string(53, 'y') + "...");
}

// A type and its bytes in a binary file.
struct TypeOfNumber {
    const char* name;
    size_t size;
};

TEST(PlyHeaders, NumbersOfAnyTypeTakeTheirBytes) {
    for (const auto& [name, size] : std::initializer_list<TypeOfNumber>{
             {"bool", 1},    {"char", 1},   {"int8", 1}, {"uchar", 1},  {"uint8", 1}, {"short", 2},  {"int16", 2},
             {"ushort", 2},  {"uint16", 2}, {"int", 4},  {"int32", 4},  {"uint", 4},  {"uint32", 4}, {"float", 4},
             {"float32", 4}, {"int64", 8},  {"long", 8}, {"uint64", 8}, {"ulong", 8}, {"double", 8}, {"float64", 8}}) {
        const std::string one(size, '\xff'), type(name);
        std::string file = fmt::format("{0}element before 2\nproperty {1} a\nproperty list uchar {1} b\n"
                                       "element vertex 1\nproperty {1} c\n{2}property list ushort {1} d\nend_header\n",
                                       kBinary, type, kXyz);
        for (const std::string& part : {one, std::string(1, '\3'), one, one, one, one, std::string(1, '\0'), one,
                                        kPlace, raw(uint16_t(2)), one, one})
            file += part;
        const PointCloud cloud = readPly(file);
        EXPECT_EQ(cloud.position, (std::vector<glm::vec3>{{1, 2, 3}})) << name;
        EXPECT_EQ(cloud.ignored, (std::vector<std::string>{"c", "d"})) << name;
    }
    // A place of eight bytes, and lists as long as a number of any whole type says.
    const std::string head = kBinary + "element vertex 1\nproperty int64 x\nproperty bool y\nproperty uint64 z\n";
    EXPECT_EQ(readPly(head + "end_header\n" + raw(int64_t(-5)) + "\1" + raw(uint64_t(7))).position,
              (std::vector<glm::vec3>{{-5, 1, 7}}));
    for (const char* length : {"bool", "char", "short", "int", "int64"})
        expectFour(readPly(fourWith(fmt::format("property list {} int64 a\n", length), "2 5 -9000000000000000000")));
}

TEST(PlyHeaders, APropertyOfAnUnknownTypeIsNamed) {
    for (const char* line : {"half a_name", "list uchar half a_name", "list half int a_name", "FLOAT a_name"})
        expectPlyRefused(fourWith(fmt::format("property {}\n", line), "1"),
                         "a.ply:7: PLY: property a_name has an unknown type; expected char, uchar");
    expectPlyRefused(fourWith("property half " + std::string(500, 'n') + "\n", "1"), "nnn... has an unknown type");
}

TEST(PlyHeaders, AsManyPropertiesAndElementsAsThereMayBe) {
    const auto lines = [](size_t count, const std::string& begin, const std::string& end) {
        std::string out;
        for (size_t i = 0; i < count; ++i) out += fmt::format("{}{}{}", begin, i, end);
        return out;
    };
    for (const size_t count : {77u, 1021u}) {
        const PointCloud cloud = readPly(fourWith(lines(count, "property uchar p", "\n"), lines(count, "", " ")));
        expectFour(cloud);
        EXPECT_EQ(cloud.ignored.size(), count);
    }
    expectPlyRefused(fourWith(lines(1022, "property uchar p", "\n"), lines(1022, "", " ")),
                     "a.ply:1028: PLY: element vertex has more than 1024 properties");
    const std::string plain = asciiPly("", kFour);
    for (const char* where : {"element vertex", "end_header"}) {
        expectFour(readPly(replaced(plain, where, lines(255, "element e", " 0\nproperty int a\n") + where)));
        expectPlyRefused(replaced(plain, where, lines(256, "element e", " 0\n") + where), "more than 256 elements");
    }
}

const std::string kCells = "element tetrahedron 1\nproperty list uchar int indices\n";

TEST(PlyHeaders, WhatIsReadIsThereOnce) {
    const auto with = [](const std::string& more) {
        return replaced(asciiPly("", kFour), "end_header", more + "end_header");
    };
    for (const char* more :
         {"element vertex 0\n", "element vertex 4\n", "element face 0\nelement vertex 1\nproperty int x\n",
          "element vertex 1\nelement vertex 1\n"})
        expectPlyRefused(with(more), "element vertex is there twice");
    const std::string cells =
        replaced(fourWith("property float sigma_t\n", "1"), "end_header", kCells + kCells + "end_header");
    expectPlyRefused(cells + "4 0 1 2 3\n4 0 1 2 3\n", "element tetrahedron is there twice", {.tetrahedra = true});
    expectFour(readPly(cells), "nobody asked for them");
    expectPlyRefused(kBinary + "element chunk 0\nelement chunk 0\nelement vertex 1\nproperty uint packed_position\n"
                               "end_header\n",
                     "element chunk is there twice");
    // Of others there may be more.
    expectFour(readPly(with("element face 0\nelement edge 0\nelement face 0\n")));
}

TEST(PlyHeaders, PropertiesThatAreReadAreThereOnce) {
    for (const char* name : {"x", "z", "scale", "sigma_t", "red", "diffuse_blue", "opacity"})
        expectPlyRefused(fourWith("property float a\nproperty float " + std::string(name) + "\nproperty double " +
                                      name + "\nproperty float b\n",
                                  "1 1 1 1"),
                         "vertex property " + std::string(name) + " is there twice");
    expectFour(readPly(fourWith("property float a\nproperty int a\n", "1 1")));
    std::string splat;
    for (const char* name : {"f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0"})
        splat += std::string("property float ") + name + "\n";
    for (const char* name : {"y", "f_dc_1", "opacity", "scale_2", "rot_0"})
        expectPlyRefused(fourWith(splat + "property float " + name + "\n", "0 0 0 0 0 0 0 1 5"),
                         "vertex property " + std::string(name) + " is there twice");
    for (const char* name : {"indices", "s"}) {
        const std::string cells = kCells + "property float s\nproperty " + (*name == 's' ? "int " : "list uchar int ");
        expectPlyRefused(replaced(asciiPly("", kFour), "end_header", cells + name + "\nend_header") + "4 0 1 2 3 1 0\n",
                         "tetrahedron property " + std::string(name) + " is there twice", {.tetrahedra = true});
    }
}

TEST(PlyHeaders, EveryElementThatIsNotReadIsTold) {
    const std::string list = "\nproperty list uchar int vertex_indices\n", long_name(500, 'n');
    const std::string head = kBinary + "element edge 1\nproperty short a\nelement vertex 1\n" + kXyz +
                             "element face 2" + list + "element empty 0" + list + "element " + long_name +
                             " 1\nproperty uchar b\n" + "element \x1b[2J 3\nproperty uchar b\nend_header\n";
    const PointCloud cloud = readPly(head + "ab" + kPlace + '\0' + '\0' + "abcd");
    EXPECT_EQ(cloud.notes,
              (std::vector<std::string>{"element edge, 1 row, is ignored", "element face, 2 rows, is ignored",
                                        "element " + long_name.substr(0, 40) + "..., 1 row, is ignored",
                                        "element ?[2J, 3 rows, is ignored"}));
    EXPECT_EQ(cloud.position, (std::vector<glm::vec3>{{1, 2, 3}}));
}

} // namespace
} // namespace brume::ply_headers_test
