// BoundingTree: axis-aligned boxes around boxes, so that who looks for things along a ray asks a few of many.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace brume {

struct Bounds3 {
    glm::dvec3 lo{1e300}, hi{-1e300}; // m; at first they hold nothing

    void add(const Bounds3& o) {
        lo = glm::min(lo, o.lo);
        hi = glm::max(hi, o.hi);
    }
};

struct BoundingNode {
    static constexpr uint32_t kInner = ~0u;

    Bounds3 bounds;
    uint32_t next = 0; // where the walk goes on that leaves this node out; it goes from a node to the one behind it
    uint32_t item = kInner; // of a leaf: the index of its item
};

// The tree of `items`, a leaf for each: 2 n - 1 nodes, the root first. Halves have the least sum of surface times items
// (the surface area heuristic, MacDonald and Booth 1990); from some depth on they have as many items. So no tree is
// deeper than 96, whatever the items are. Equal items give equal trees.
std::vector<BoundingNode> boundingTree(std::span<const Bounds3> items);

} // namespace brume
