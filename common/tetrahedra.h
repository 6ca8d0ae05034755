// Tetrahedra: a mesh whose corners are the points of a file, and how its tetrahedra lie side by side.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "common/bounding_tree.h"

namespace brume {

struct Tetrahedra {
    static constexpr uint32_t kOutside = ~0u;
    static constexpr size_t kMostFaces = 500'000; // of the outside

    // A face with a tetrahedron on one side only. Seen from outside, its corners go round counterclockwise.
    struct Face {
        glm::uvec3 corners; // indices of points
        uint32_t cell;      // index of its tetrahedron
    };

    // Of each tetrahedron: indices of points a, b, c, d in such an order that dot(cross(b - a, c - a), d - a) >= 0.
    std::vector<glm::uvec4> corners;
    std::vector<glm::uvec4> neighbours; // [m]: the tetrahedron behind the face that corner m is not of, or kOutside
    std::vector<Face> faces;            // of the outside
    std::vector<BoundingNode> tree;     // of `faces`, with the points where the file has them
    uint32_t points = 0;                // how many are corners
};

// `corners`: of each tetrahedron four indices of `points`. For messages: `name` of the file, and `vertex`, the file's
// number of each point; empty: its index.
// Throws SceneError, one line, if an index is not of a point or is there twice in one tetrahedron; if a face has three
// tetrahedra; if the two tetrahedra of a face lie on the same side of it; or for more than kMostFaces. A tetrahedron
// may be flat: then it has the order of corners that its neighbours ask for. Equal tetrahedra give equal results.
Tetrahedra connected(std::vector<glm::uvec4> corners, std::span<const glm::vec3> points, const std::string& name,
                     std::span<const uint32_t> vertex = {});

// The box of a face. `points` may have moved since the tree was made.
Bounds3 boundsOf(const Tetrahedra::Face& face, std::span<const glm::vec3> points);

} // namespace brume
