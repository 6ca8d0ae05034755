// What of a bounding tree (common/bounding_tree.h) a ray meets.
#pragma once

#include <span>

#include "common/bounding_tree.h"
#include "tools/reference/world.h"

namespace brume::reference {

// True if some of the ray between its begin and its end is in the box.
bool passes(const Bounds3& bounds, const Ray& ray);
// True if the plane through `origin` meets the box.
bool meetsPlane(const Bounds3& bounds, glm::dvec3 normal, glm::dvec3 origin);

// Calls visit(item) for items in nodes that `enters` is true for, until one returns true. Returns whether one did.
template <class Enters, class Visit>
bool walk(std::span<const BoundingNode> nodes, const Enters& enters, const Visit& visit) {
    for (size_t n = 0; n < nodes.size();) {
        const BoundingNode& node = nodes[n];
        const bool entered = enters(node.bounds);
        if (entered && node.item != BoundingNode::kInner && visit(node.item)) return true;
        n = entered ? n + 1 : node.next;
    }
    return false;
}

} // namespace brume::reference
