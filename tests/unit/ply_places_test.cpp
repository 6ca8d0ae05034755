// Places of PLY files that are hard to show: far from zero or from each other, tiny, huge, none; and tetrahedra.
#include <fmt/format.h>

#include "common/ply/upload_frame.h"
#include "tests/unit/ply_reading.h"

namespace brume::ply_places_test {
namespace {

using test::asciiPly, test::expectPlyRefused, test::fourWith, test::kFour, test::kXyz, test::readPly, test::replaced,
    test::tells;

// So many points in layers of 5 x 5, `step` apart, and others.
std::string blockAnd(int count, double step, const std::string& others) {
    std::string points;
    for (int i = 0; i < count; ++i) {
        const int row = i / 5 % 5, layer = i / 25;
        points += fmt::format("{} {} {}\n", step * (i % 5), step * row, step * layer);
    }
    return asciiPly("", points + others);
}

TEST(PlyPlaces, PointsFarFromTheOthersAreToldInCloudsOfAnySize) {
    struct Far {
        int count; // of points together
        double step;
        const char *others, *told; // told: empty: nothing
        size_t far;
    };
    std::string many;
    for (int i = 0; i < 200; ++i) many += fmt::format("{} 0 0\n", 40000 + i);
    for (const auto& [count, step, others, told, far] :
         std::initializer_list<Far>{{49, 1, "0 0 -40000\n", "1 point is 40 km from the others", 1},
                                    {48, 1, "0 49000 0\n", "1 point is 49 km from the others", 1},
                                    {20, 1, "0 -2000 0\n", "1 point is 2.001 km from the others", 1},
                                    {7, 1, "40000 40000 40000\n", "1 point is 40 km from the others", 1},
                                    {125, 0.001, "0.5 0 0\n", "1 point is 0.498 m from the others", 1},
                                    {125, 1000, "-37000 0 0\n", "", 0}, // 19.5 times as far as the others reach
                                    {125, 1, "1e30 0 0\n", "1 point is 1e+27 km from the others", 1},
                                    {125, 1, "nan 0 0\n-5000 0 0\ninf 0 0\n", "1 point is 5.002 km from the others", 1},
                                    {125, 1, "9000 0 0\n-9000 0 0\n", "2 points are up to 9.002 km from the others", 2},
                                    {10000, 1, many.c_str(), "200 points are up to 40.2 km from the others", 200},
                                    {7, 1, "40000 0 0\n-40000 0 0\n", "", 0}, // two of nine may be the cloud
                                    {6, 1, "40000 0 0\n", "", 0}}) {
        const std::string bytes = blockAnd(count, step, others);
        const PointCloud kept = readPly(bytes), dropped = readPly(bytes, {.drop_far = true});
        const std::string it = far == 1 ? "it" : "them";
        if (!*told) {
            EXPECT_TRUE(kept.notes.empty()) << testing::PrintToString(kept.notes);
            EXPECT_EQ(dropped.position.size(), kept.position.size());
            continue;
        }
        EXPECT_EQ(kept.notes,
                  std::vector<std::string>{std::string(told) + "; medium.far_points = \"drop\" leaves " + it + " out"});
        EXPECT_EQ(dropped.notes,
                  std::vector<std::string>{std::string(told) + " and left out; far_points = \"keep\" keeps " + it});
        EXPECT_EQ(dropped.position.size(), size_t(count));
    }
    // In the scene's unit, and turned.
    const PointCloud cloud = readPly(blockAnd(125, 1000, "0 0 4e6\n"), {}, {.unit = 0.001, .up = "z"});
    EXPECT_EQ(cloud.notes.at(0).find("1 point is 3.998 km from the others"), 0u) << cloud.notes.at(0);
}

// What is chosen for a file that is uploaded without a word.
TEST(PlyPlaces, UploadsAreBroughtToWhereTheyAreSeen) {
    struct Upload {
        std::string points;
        double unit;
        glm::dvec3 origin;
        const char* told; // part of a note; empty: no note at all
    };
    const std::string utm = "700000 5300000 400\n700001 5300000 400\n700000 5300002 400\n700000 5300000 403\n";
    for (const auto& [points, unit, origin, told] : std::initializer_list<Upload>{
             {kFour, 1, {0, 0, 0}, ""},
             {"0 0 0\n0.02 0 0\n0.01 0 0\n", 1, {0, 0, 0}, ""},
             {"0 0 0\n0.0198 0 0\n0.0099 0 0\n", 100, {0, 0, 0}, "within 0.02 m, and are shown 100 times as large"},
             {"0 0 0\n4e-6 0 0\n2e-6 0 0\n", 1e6, {0, 0, 0}, "within 4e-06 m, and are shown 1e+06 times as large"},
             {"0 0 0\n4e-10 0 0\n2e-10 0 0\n", 1e9, {0, 0, 0}, "shown 1e+09 times as large"}, // the largest unit
             {"0 0 0\n1e5 0 0\n5e4 0 0\n", 0.1, {0, 0, 0}, "shown 0.1 times as large"},
             {"0 0 0\n4e9 0 0\n2e9 0 0\n", 1e-6, {0, 0, 0}, "shown 1e-06 times as large"},
             {"0 0 0\n0 0 0\n0 0 0\n", 1, {0, 0, 0}, ""},
             {utm, 1, {700000, 5300000, 400}, "origin is moved to the points: [700000, 5300000, 400]"},
             {"-2694045.5 -4266891 3888310\n-2694044.5 -4266891 3888310\n-2694045.5 -4266890 3888311\n",
              1,
              {-2694046, -4266891, 3888310},
              "[-2694046, -4266891, 3888310]"},
             {"1e6 0 0\n1000000.000002 0 0\n1000000.000001 0 0\n", 1e6, {1e12, 0, 0}, "refused"},
         }) {
        const std::string bytes = replaced(asciiPly("", points), "float", "double");
        const PlyExtent extent = extentOf(bytes, "a.ply", "y");
        if (told == std::string("refused")) {
            EXPECT_THROW(UploadFrame(extent, {}), SceneError) << "tiny and far from zero";
            continue;
        }
        const UploadFrame frame(extent, {});
        EXPECT_DOUBLE_EQ(frame.unit, unit) << points;
        EXPECT_EQ(frame.origin, origin) << points << frame.origin.x;
        EXPECT_EQ(frame.notes.size(), *told ? 1u : 0u) << points << testing::PrintToString(frame.notes);
        EXPECT_TRUE(!*told || frame.notes.at(0).find(told) != std::string::npos) << frame.notes.at(0);
        // All of the points are there in that frame.
        const PointCloud cloud = parsePly(bytes, "a.ply", {.origin = frame.origin, .unit = frame.unit});
        EXPECT_EQ(cloud.dropped, 0u) << cloud.first_dropped;
    }
    // Turned, the origin is the turned one. In millimetres it is in metres.
    const std::string doubles = replaced(asciiPly("", utm), "float", "double");
    EXPECT_EQ(UploadFrame(extentOf(doubles, "a.ply", "z"), {.up = "z"}).origin, glm::dvec3(700000, 400, -5300000));
    EXPECT_EQ(UploadFrame(extentOf(doubles, "a.ply", "y"), {.unit = 0.001}).origin, glm::dvec3(700, 5300, 0));
    const UploadFrame as_given(extentOf(doubles, "a.ply", "y"), {.unit = 1, .origin = glm::dvec3(700000, 5300000, 0)});
    EXPECT_TRUE(as_given.notes.empty());
}

// Each line says what can be done by whoever has no scene file.
TEST(PlyPlaces, UploadsThatCannotBeSeenSayWhy) {
    const auto why = [](const std::string& points) -> std::string {
        try {
            const std::string bytes = replaced(asciiPly("", points), "float", "double");
            UploadFrame(extentOf(bytes, "a.ply", "y"), {});
        } catch (const SceneError& error) {
            return error.what();
        }
        return "no error";
    };
    EXPECT_EQ(why("0 0 0\n4e-13 0 0\n2e-13 0 0\n"),
              "the points lie within 4e-13 m; allowed: 2e-11 to 2e+13 m, so scale the file");
    EXPECT_EQ(why("0 0 0\n4e20 0 0\n2e20 0 0\n"),
              "the points lie within 4e+20 m; allowed: 2e-11 to 2e+13 m, so scale the file");
    EXPECT_EQ(why("7e8 0 0\n700001000 0 0\n700000500 0 0\n"),
              "the points are 7e+08 m from zero; allowed: within 10,000 km; if their unit is not the metre, say so: "
              "medium.unit = \"mm\", or unit=mm with an upload");
}

TEST(PlyPlaces, AFileWithoutPointsMayHaveAnyForm) {
    const std::string binary = "ply\nformat binary_big_endian 1.0\nelement vertex 0\n" + kXyz + "end_header\n";
    std::string splats;
    for (const char* name : {"f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0"})
        splats += "property float " + std::string(name) + "\n";
    const std::string mesh =
        replaced(asciiPly("", ""), "end_header", "element face 0\nproperty list uchar int i\nend_header");
    for (const std::string& bytes :
         {asciiPly("", ""), binary, asciiPly(splats, ""), mesh, replaced(asciiPly("", ""), "\n", "\r"),
          asciiPly("property uchar red\nproperty int id\n", "")}) {
        EXPECT_TRUE(readPly(bytes, {.ids = true, .may_be_empty = true}).position.empty());
        EXPECT_TRUE(readPly(bytes, {.axes = true, .may_be_empty = true, .drop_far = true}).position.empty());
        expectPlyRefused(bytes, "element vertex has 0 points; allowed: 1 to 1000000");
        EXPECT_EQ(extentOf(bytes, "a.ply", "y").count, 0u);
    }
    expectPlyRefused(replaced(asciiPly("", ""), "vertex", "points"), "no element vertex", {.may_be_empty = true});
}

// A cell of 4 corners in a file, with its extinction there or at the corners.
std::string cell(const std::string& of_corner, const std::string& corner, const std::string& of_cell,
                 const std::string& value) {
    return replaced(fourWith(of_corner, corner), "end_header", "element tetrahedron 1\n" + of_cell + "end_header") +
           value + "\n";
}

TEST(PlyPlaces, ExtinctionsOfTetrahedraAreTheirsOrTheirCorners) {
    const std::string sigma_t = "property float sigma_t\n", s = "property float s\n";
    for (const char* name : {"indices", "vertex_index", "vertex_indices"}) {
        const std::string list = "property list uchar int " + std::string(name) + "\n";
        struct Cell {
            std::string of_corner, corner, of_cell, value;
            float extinction;
            const char* told;
        };
        for (const Cell& one : std::initializer_list<Cell>{
                 {"", "", list + s, "4 0 1 2 3 0.5", 0.5f,
                  "each corner has the mean extinction of its tetrahedra, whose own is s"},
                 {"", "", s + list, "0.5 4 3 2 1 0", 0.5f, "whose own is s"},
                 {"", "", list + sigma_t, "4 0 1 2 3 2", 2, "whose own is sigma_t"},
                 {sigma_t, "1", list, "4 0 1 2 3", 1, ""},
                 {sigma_t, "1", list + s, "4 0 1 2 3 0.5", 1, "properties of element tetrahedron are ignored: s"},
                 {sigma_t, "1", list + "property int id\nproperty uchar material\n", "4 0 1 2 3 7 8", 1,
                  "properties of element tetrahedron are ignored: id, material"},
             }) {
            const PointCloud cloud =
                readPly(cell(one.of_corner, one.corner, one.of_cell, one.value), {.tetrahedra = true}, {.unit = 0.5});
            ASSERT_EQ(cloud.tetrahedra.size(), 1u);
            EXPECT_EQ(cloud.position[3], glm::vec3(0, 0, 1.5f));
            EXPECT_EQ(cloud.sigma_t, std::vector<float>(4, 2 * one.extinction)) << one.of_cell << "per unit";
            EXPECT_EQ(cloud.notes.size(), *one.told ? 1u : 0u) << testing::PrintToString(cloud.notes);
            EXPECT_TRUE(!*one.told || tells(cloud, one.told)) << testing::PrintToString(cloud.notes);
        }
    }
    for (const char* wrong : {"nan", "-0.5", "inf", "10001"})
        expectPlyRefused(cell("", "", "property list uchar int indices\n" + s, "4 0 1 2 3 " + std::string(wrong)),
                         std::string("a.ply: PLY: element tetrahedron, line 15: s is ") + wrong +
                             "; allowed: 0 to 10000",
                         {.tetrahedra = true});
}

} // namespace
} // namespace brume::ply_places_test
