// TetrahedraTree: the exact way of a ray through a medium of tetrahedra. Each tetrahedron is met by itself, in a tree
// of bounds: nothing is known of neighbours, and corners may have moved in any way.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/reference/bounds.h"
#include "tools/reference/world.h"

namespace brume::reference {

// What of a ray is in one tetrahedron, or in a cell between voxels. Extinction and albedo are linear in between, but
// for what `bend` adds: at the part u of the way u (1 - u) (bend[0] + bend[1] u).
struct CellPart {
    double begin, end;      // m
    double extinction[2];   // 1/m, at both ends
    glm::dvec3 albedo[2]{}; // at both ends
    double bend[2]{};       // 1/m; of a tetrahedron 0

    bool holds(double t) const { return t > begin && t < end; }
    double extinctionAt(double t) const;
    glm::dvec3 albedoAt(double t) const;
    // Optical depth from its begin to t, or to its end.
    double depthTo(double t) const;
    // The t at which that depth is reached; kInfinity if there is none. Of a tetrahedron, as cut() is.
    double whereDepthIs(double depth) const;
    // The part of it between these.
    CellPart cut(Interval to) const;
};

class TetrahedraTree {
public:
    // `medium` must outlive it.
    explicit TetrahedraTree(const TetrahedralMedium& medium);

    // The parts of [ray.begin, ray.end] in tetrahedra, by their begin. Where two tetrahedra share a face, one ends at
    // the very t at which the other begins. A ray along a face, along an edge or through a corner is in just one at a
    // time.
    void along(const Ray& ray, std::vector<CellPart>& parts) const;
    // Optical depth between ray.begin and ray.end.
    double depth(const Ray& ray) const;
    // Appends every t on the ray's line at which an edge on the outside is in line with the light: there the slope of
    // the depth toward the light has a jump. At edges on the inside only the slope's own slope has one.
    void shadowEdges(const LightSource& light, const Ray& ray, std::vector<double>& t) const;

private:
    using Edge = std::array<uint32_t, 2>; // indices of corners, in order

    std::vector<Edge> outside() const; // edges of faces that are of one tetrahedron only

    const TetrahedralMedium& medium_;
    std::vector<BoundingNode> nodes_; // of the tetrahedra
    std::vector<Edge> edges_;
    std::vector<BoundingNode> edge_nodes_;
};

} // namespace brume::reference
