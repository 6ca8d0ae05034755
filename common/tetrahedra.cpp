#include "common/tetrahedra.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "common/scene.h"
#include "common/scene_limits.h"

namespace brume {

namespace {

constexpr uint32_t kNone = Tetrahedra::kOutside;

// [m]: the face that corner m is not of. Seen from outside, its corners go round counterclockwise if the volume is
// positive.
constexpr std::array<std::array<int, 3>, 4> kFaces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

glm::uvec3 faceOf(const glm::uvec4& cell, uint32_t m) {
    const auto& [a, b, c] = kFaces[m];
    return {cell[a], cell[b], cell[c]};
}

// A face as one of its tetrahedra has it.
struct Side {
    uint64_t key;  // the face's corners, in order
    uint32_t side; // 4 * index of the tetrahedron + corner that is not of the face

    uint32_t cell() const { return side / 4; }
    uint32_t corner() const { return side % 4; }
};

constexpr int kIndexBits = 21;
static_assert(limits::kCount.hi <= double(1 << kIndexBits) && limits::kTetrahedra.hi < double(1u << 30));

uint64_t keyOf(glm::uvec3 face) {
    if (face.x > face.y) std::swap(face.x, face.y);
    if (face.y > face.z) std::swap(face.y, face.z);
    if (face.x > face.y) std::swap(face.x, face.y);
    return (uint64_t(face.x) << (2 * kIndexBits)) | (uint64_t(face.y) << kIndexBits) | face.z;
}

glm::uvec3 cornersOf(uint64_t key) {
    constexpr uint32_t kMask = (1u << kIndexBits) - 1;
    return {uint32_t(key >> (2 * kIndexBits)), uint32_t(key >> kIndexBits) & kMask, uint32_t(key) & kMask};
}

// True: the corners go round in opposite ways. Precondition: they are the same three.
bool areOpposite(const glm::uvec3& a, const glm::uvec3& b) {
    const int from = b.x == a.x ? 0 : b.y == a.x ? 1 : 2;
    return b[(from + 1) % 3] != a.y;
}

// Sign of the volume; 0: the tetrahedron is flat, as far as doubles tell (Shewchuk 1997).
int orientation(const glm::uvec4& cell, std::span<const glm::vec3> points) {
    const glm::dvec3 a(points[cell.x]), b = glm::dvec3(points[cell.y]) - a, c = glm::dvec3(points[cell.z]) - a,
                                        d = glm::dvec3(points[cell.w]) - a;
    const glm::dvec3 across = glm::cross(b, c), first(b.y * c.z, b.z * c.x, b.x * c.y),
                     second(b.z * c.y, b.x * c.z, b.y * c.x);
    const double six_volumes = glm::dot(across, d);
    const double most = glm::dot(glm::abs(first) + glm::abs(second), glm::abs(d));
    if (std::abs(six_volumes) <= 4 * std::numeric_limits<double>::epsilon() * most) return 0;
    return six_volumes > 0 ? 1 : -1;
}

void turn(glm::uvec4& cell) { std::swap(cell.z, cell.w); }

class Connector {
public:
    Connector(std::vector<glm::uvec4> corners, std::span<const glm::vec3> points, const std::string& name,
              std::span<const uint32_t> vertex)
        : points_(points), name_(name), vertex_(vertex), solid_(corners.size()) {
        out_.corners = std::move(corners);
        out_.neighbours.resize(out_.corners.size(), glm::uvec4(kNone));
        out_.points = uint32_t(points.size());
    }

    Tetrahedra connect() {
        for (uint32_t cell = 0; cell < out_.corners.size(); ++cell) orient(cell);
        meet();
        turnFlat();
        for (uint32_t cell = 0; cell < out_.corners.size(); ++cell)
            for (uint32_t m = 0; m < 4; ++m)
                if (out_.neighbours[cell][int(m)] == kNone) out_.faces.push_back({faceOf(out_.corners[cell], m), cell});
        if (out_.faces.size() > Tetrahedra::kMostFaces)
            fail(fmt::format("{} faces of tetrahedra are outside; expected up to {}: those side by side have the same "
                             "vertices",
                             out_.faces.size(), Tetrahedra::kMostFaces));
        if (out_.faces.empty()) fail("the tetrahedra have no outside; expected some that are not flat");
        std::vector<Bounds3> boxes;
        boxes.reserve(out_.faces.size());
        for (const Tetrahedra::Face& face : out_.faces) boxes.push_back(boundsOf(face, points_));
        out_.tree = boundingTree(boxes);
        return std::move(out_);
    }

private:
    uint32_t numberOf(uint32_t point) const { return vertex_.empty() ? point : vertex_[point]; }
    [[noreturn]] void fail(const std::string& what) const { throw SceneError(name_ + ": PLY: " + what); }

    void orient(uint32_t cell) {
        glm::uvec4& corners = out_.corners[cell];
        for (int m = 0; m < 4; ++m) {
            if (corners[m] >= points_.size())
                fail(fmt::format("row {} of element tetrahedron: there is no vertex {}; expected 0 to {}", cell + 1,
                                 corners[m], points_.size() - 1));
            for (int other = 0; other < m; ++other)
                if (corners[m] == corners[other])
                    fail(fmt::format("row {} of element tetrahedron: vertex {} is there twice; expected four "
                                     "different ones",
                                     cell + 1, numberOf(corners[m])));
        }
        const int sign = orientation(corners, points_);
        solid_[cell] = sign != 0;
        if (sign < 0) turn(corners);
    }

    // Finds who meets whom.
    void meet() {
        std::vector<Side> sides;
        sides.reserve(4 * out_.corners.size());
        for (uint32_t cell = 0; cell < out_.corners.size(); ++cell)
            for (uint32_t m = 0; m < 4; ++m) sides.push_back({keyOf(faceOf(out_.corners[cell], m)), 4 * cell + m});
        std::ranges::sort(
            sides, [](const Side& a, const Side& b) { return a.key < b.key || (a.key == b.key && a.side < b.side); });
        for (size_t i = 1; i < sides.size(); ++i) {
            const Side &a = sides[i - 1], &b = sides[i];
            if (a.key != b.key) continue;
            const glm::uvec3 face = cornersOf(a.key);
            const std::string text =
                fmt::format("of vertices {}, {} and {}", numberOf(face.x), numberOf(face.y), numberOf(face.z));
            if (i + 1 < sides.size() && sides[i + 1].key == a.key)
                fail(fmt::format("rows {}, {} and {} of element tetrahedron have the same face, {}; expected two at "
                                 "most",
                                 a.cell() + 1, b.cell() + 1, sides[i + 1].cell() + 1, text));
            if (solid_[a.cell()] && solid_[b.cell()] && !isBetween(a, b))
                fail(fmt::format("rows {} and {} of element tetrahedron lie on the same side of their face, {}; "
                                 "expected one on each",
                                 a.cell() + 1, b.cell() + 1, text));
            out_.neighbours[a.cell()][int(a.corner())] = b.cell();
            out_.neighbours[b.cell()][int(b.corner())] = a.cell();
        }
    }

    // True: the face has one of the two tetrahedra on each side.
    bool isBetween(const Side& a, const Side& b) const {
        return areOpposite(faceOf(out_.corners[a.cell()], a.corner()), faceOf(out_.corners[b.cell()], b.corner()));
    }

    // Gives flat tetrahedra the order of corners that their neighbours ask for.
    void turnFlat() {
        if (std::ranges::find(solid_, false) == solid_.end()) return;
        std::vector<bool> known = solid_;
        std::vector<uint32_t> next;
        const auto go = [&] {
            while (!next.empty()) {
                const uint32_t cell = next.back();
                next.pop_back();
                for (uint32_t m = 0; m < 4; ++m) {
                    const uint32_t other = out_.neighbours[cell][int(m)];
                    if (other == kNone || known[other]) continue;
                    turnLike(cell, m, other);
                    known[other] = true;
                    next.push_back(other);
                }
            }
        };
        for (uint32_t cell = 0; cell < known.size(); ++cell)
            if (solid_[cell]) next.push_back(cell);
        go();
        for (uint32_t cell = 0; cell < known.size(); ++cell) { // nobody asks those
            if (known[cell]) continue;
            known[cell] = true;
            next.push_back(cell);
            go();
        }
    }

    void turnLike(uint32_t cell, uint32_t m, uint32_t other) {
        const glm::uvec3 face = faceOf(out_.corners[cell], m);
        for (uint32_t n = 0; n < 4; ++n) {
            const glm::uvec3 same = faceOf(out_.corners[other], n);
            if (keyOf(same) != keyOf(face)) continue;
            if (!areOpposite(same, face)) {
                turn(out_.corners[other]);
                std::swap(out_.neighbours[other].z, out_.neighbours[other].w);
            }
            return;
        }
    }

    std::span<const glm::vec3> points_;
    const std::string& name_;
    std::span<const uint32_t> vertex_; // the file's number of each point; empty: its index
    std::vector<bool> solid_;          // per tetrahedron; false: it is flat
    Tetrahedra out_;
};

} // namespace

Tetrahedra connected(std::vector<glm::uvec4> corners, std::span<const glm::vec3> points, const std::string& name,
                     std::span<const uint32_t> vertex) {
    return Connector(std::move(corners), points, name, vertex).connect();
}

Bounds3 boundsOf(const Tetrahedra::Face& face, std::span<const glm::vec3> points) {
    Bounds3 bounds;
    for (int m = 0; m < 3; ++m) bounds.add({glm::dvec3(points[face.corners[m]]), glm::dvec3(points[face.corners[m]])});
    return bounds;
}

} // namespace brume
