// Tetrahedra: how they lie side by side, what their outside is, and what is refused.
#include "common/tetrahedra.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "common/scene.h"

namespace brume {
namespace {

struct Parts {
    std::vector<glm::vec3> points;
    std::vector<glm::uvec4> cells;
};

// n^3 cubes of five tetrahedra each, every other cube mirrored so that diagonals meet. Rows have either orientation.
Parts cubes(uint32_t n) {
    Parts out;
    for (uint32_t i = 0; i < (n + 1) * (n + 1) * (n + 1); ++i)
        out.points.emplace_back(i % (n + 1), i / (n + 1) % (n + 1), i / (n + 1) / (n + 1));
    constexpr std::array<glm::uvec4, 5> kFive{{{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}}};
    for (uint32_t i = 0; i < n * n * n; ++i) {
        const glm::uvec3 cube(i % n, i / n % n, i / n / n);
        for (const glm::uvec4& five : kFive) {
            glm::uvec4& cell = out.cells.emplace_back();
            for (int m = 0; m < 4; ++m) {
                const uint32_t corner = five[m] ^ ((cube.x + cube.y + cube.z) % 2); // mirrored along x
                const glm::uvec3 at = cube + glm::uvec3(corner & 1, corner >> 1 & 1, corner >> 2);
                cell[m] = at.x + (n + 1) * (at.y + (n + 1) * at.z);
            }
        }
    }
    return out;
}

Tetrahedra connected(const Parts& mesh) { return brume::connected(mesh.cells, mesh.points, "mesh.ply"); }

std::set<uint32_t> cornersWithout(const glm::uvec4& cell, int m) {
    std::set<uint32_t> corners{cell.x, cell.y, cell.z, cell.w};
    corners.erase(cell[m]);
    return corners;
}

double volumeOf(const glm::uvec4& cell, const std::vector<glm::vec3>& points) {
    const glm::dvec3 a(points[cell.x]), b(points[cell.y]), c(points[cell.z]), d(points[cell.w]);
    return glm::dot(glm::cross(b - a, c - a), d - a) / 6;
}

// Checks that neighbours are mutual, each behind the face that both have, and that the other faces are the outside.
void expectSides(const Tetrahedra& all) {
    std::set<std::set<uint32_t>> outside;
    for (const Tetrahedra::Face& face : all.faces) {
        const std::set<uint32_t> corners{face.corners.x, face.corners.y, face.corners.z};
        EXPECT_TRUE(outside.insert(corners).second) << "a face is outside once";
        bool is_of_it = false;
        for (int m = 0; m < 4; ++m) is_of_it |= cornersWithout(all.corners.at(face.cell), m) == corners;
        EXPECT_TRUE(is_of_it);
    }
    ASSERT_EQ(all.neighbours.size(), all.corners.size());
    for (uint32_t cell = 0; cell < all.corners.size(); ++cell)
        for (int m = 0; m < 4; ++m) {
            const uint32_t other = all.neighbours[cell][m];
            const std::set<uint32_t> face = cornersWithout(all.corners[cell], m);
            EXPECT_EQ(outside.count(face), other == Tetrahedra::kOutside ? 1u : 0u);
            if (other == Tetrahedra::kOutside) continue;
            int back = 0;
            for (int n = 0; n < 4; ++n)
                back += all.neighbours[other][n] == cell && cornersWithout(all.corners[other], n) == face;
            EXPECT_EQ(back, 1) << cell << ' ' << m;
        }
}

// Half the cross products of the outside's faces: their sum, the sum of their lengths, and the volume within.
struct Outside {
    glm::dvec3 sum{0};
    double area = 0, volume = 0;
};
Outside outsideOf(const Tetrahedra& all, const std::vector<glm::vec3>& points) {
    Outside out;
    for (const Tetrahedra::Face& face : all.faces) {
        const glm::dvec3 a(points[face.corners.x]), b(points[face.corners.y]), c(points[face.corners.z]);
        const glm::dvec3 area = 0.5 * glm::cross(b - a, c - a);
        out.sum += area;
        out.area += glm::length(area);
        out.volume += glm::dot(a, area) / 3;
    }
    return out;
}

TEST(Tetrahedra, ACubeOfFive) {
    const Parts mesh = cubes(1);
    const Tetrahedra all = connected(mesh);
    expectSides(all);
    EXPECT_EQ(all.points, 8u);
    std::set<uint32_t> round;
    for (int m = 0; m < 4; ++m) round.insert(all.neighbours[0][m]);
    EXPECT_EQ(round, (std::set<uint32_t>{1, 2, 3, 4})) << "the one in the middle has no face outside";
    EXPECT_EQ(all.faces.size(), 12u);
    const Outside outside = outsideOf(all, mesh.points);
    EXPECT_EQ(outside.sum, glm::dvec3(0)) << "it is closed";
    EXPECT_EQ(outside.area, 6);
    EXPECT_NEAR(outside.volume, 1, 1e-12) << "seen from outside, corners go round counterclockwise";
}

TEST(Tetrahedra, ManyCubes) {
    const Parts mesh = cubes(4);
    const Tetrahedra all = connected(mesh);
    expectSides(all);
    EXPECT_EQ(all.faces.size(), 6 * 16 * 2u);
    std::set<std::pair<uint32_t, uint32_t>> edges;
    for (const glm::uvec4& cell : all.corners) {
        EXPECT_GT(volumeOf(cell, mesh.points), 0);
        for (int m = 0; m < 4; ++m)
            for (int n = 0; n < m; ++n) edges.emplace(std::minmax(cell[m], cell[n]));
    }
    const size_t inner = (4 * all.corners.size() - all.faces.size()) / 2;
    EXPECT_EQ(mesh.points.size() + inner + all.faces.size(), 1 + edges.size() + all.corners.size()) << "Euler";
    const Outside outside = outsideOf(all, mesh.points);
    EXPECT_EQ(outside.sum, glm::dvec3(0));
    EXPECT_NEAR(outside.volume, 64, 1e-9);
}

TEST(Tetrahedra, TheTreeHoldsEveryFaceOfTheOutside) {
    const Parts mesh = cubes(3);
    const Tetrahedra all = connected(mesh);
    ASSERT_EQ(all.tree.size(), 2 * all.faces.size() - 1);
    std::vector<int> times(all.faces.size());
    for (const BoundingNode& node : all.tree) {
        if (node.item == BoundingNode::kInner) continue;
        ++times.at(node.item);
        EXPECT_EQ(node.bounds.lo, boundsOf(all.faces[node.item], mesh.points).lo);
        EXPECT_EQ(node.bounds.hi, boundsOf(all.faces[node.item], mesh.points).hi);
    }
    EXPECT_EQ(std::ranges::count(times, 1), ptrdiff_t(times.size()));
    EXPECT_EQ(all.tree[0].bounds.lo, glm::dvec3(0));
    EXPECT_EQ(all.tree[0].bounds.hi, glm::dvec3(3));
}

// A mesh program leaves such between points in one plane. Its outside is closed, too, and seen from outside.
TEST(Tetrahedra, OneThatIsFlatIsTurnedLikeItsNeighbours) {
    for (const glm::uvec4 flat : {glm::uvec4(4, 5, 6, 7), glm::uvec4(4, 5, 7, 6)}) {
        Parts mesh = cubes(1);
        mesh.cells.insert(mesh.cells.begin(), flat);
        const Tetrahedra all = connected(mesh);
        expectSides(all);
        EXPECT_EQ(all.faces.size(), 12u);
        int above = 0;
        for (const Tetrahedra::Face& face : all.faces) {
            if (face.cell != 0) continue;
            const glm::dvec3 a(mesh.points[face.corners.x]), b(mesh.points[face.corners.y]),
                c(mesh.points[face.corners.z]);
            EXPECT_EQ(glm::cross(b - a, c - a), glm::dvec3(0, 0, 1));
            ++above;
        }
        EXPECT_EQ(above, 2);
        EXPECT_EQ(outsideOf(all, mesh.points).sum, glm::dvec3(0));
    }
    const Parts alone{.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, .cells = {{0, 1, 2, 3}}};
    EXPECT_EQ(connected(alone).faces.size(), 4u);
}

std::string errorOf(const Parts& mesh) {
    try {
        connected(mesh);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no error";
}

TEST(Tetrahedra, RefusalsNameTheVerticesOfTheFile) {
    const std::vector<uint32_t> vertex{0, 2, 4, 6, 8, 10, 12, 14};
    Parts mesh = cubes(1);
    mesh.cells[1] = {1, 3, 5, 3};
    try {
        brume::connected(mesh.cells, mesh.points, "mesh.ply", vertex);
        ADD_FAILURE() << "no error";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("vertex 6 is there twice"), std::string::npos) << error.what();
    }
    mesh = cubes(1);
    mesh.points[7] = {0.2f, 0.2f, 0.2f};
    try {
        brume::connected(mesh.cells, mesh.points, "mesh.ply", vertex);
        ADD_FAILURE() << "no error";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("of vertices 6, 10 and 12;"), std::string::npos) << error.what();
    }
}

TEST(Tetrahedra, RefusalsAreOneLine) {
    Parts mesh = cubes(1);
    mesh.cells[2].y = 8;
    EXPECT_EQ(errorOf(mesh), "mesh.ply: PLY: row 3 of element tetrahedron: there is no vertex 8; expected 0 to 7");
    mesh = cubes(1);
    mesh.cells[1] = {1, 3, 5, 3};
    EXPECT_EQ(errorOf(mesh),
              "mesh.ply: PLY: row 2 of element tetrahedron: vertex 3 is there twice; expected four different ones");
    mesh = cubes(1);
    mesh.points.emplace_back(5, 5, 4);
    mesh.cells.emplace_back(8, 6, 5, 3);
    EXPECT_EQ(errorOf(mesh), "mesh.ply: PLY: rows 1, 5 and 6 of element tetrahedron have the same face, of vertices 3, "
                             "5 and 6; expected two at most");
    mesh = cubes(1);
    mesh.points[7] = {0.2f, 0.2f, 0.2f};
    EXPECT_EQ(errorOf(mesh), "mesh.ply: PLY: rows 1 and 5 of element tetrahedron lie on the same side of their face, "
                             "of vertices 3, 5 and 6; expected one on each");
    mesh = cubes(1);
    mesh.cells.erase(mesh.cells.begin());
    mesh.cells.push_back(mesh.cells[0]);
    EXPECT_NE(errorOf(mesh).find("rows 1 and 5 of element tetrahedron lie on the same side"), std::string::npos);
    mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2, 3}, {0, 1, 2, 3}}};
    EXPECT_EQ(errorOf(mesh), "mesh.ply: PLY: the tetrahedra have no outside; expected some that are not flat");
    mesh = {};
    for (uint32_t i = 0; i < 125'001; ++i) {
        for (const glm::vec3 corner : {glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)})
            mesh.points.push_back(corner);
        mesh.cells.push_back(4 * i + glm::uvec4(0, 1, 2, 3));
    }
    EXPECT_EQ(errorOf(mesh), "mesh.ply: PLY: 500004 faces of tetrahedra are outside; expected up to 500000: those side "
                             "by side have the same vertices");
}

} // namespace
} // namespace brume
