#include "server/opaque/mesh_buffers.h"

#include <algorithm>
#include <cmath>

#include "server/inputs/objects.h"
#include "server/opaque/object_buffers.h"

namespace brume {
namespace {

// Writes the nodes of a tree in the order in which rays of one order want them.
class Ordered {
public:
    Ordered(std::span<const BoundingNode> tree, std::vector<gpu::ObjectNode>& out) : tree_(tree), out_(out) {}

    // `order`: bits of the axes x, z and y along which rays go backward.
    void add(uint32_t order, uint32_t node = 0) {
        const size_t at = out_.size();
        out_.push_back(objectNode(tree_[node]));
        if (tree_[node].item == BoundingNode::kInner) {
            const uint32_t first = node + 1, second = tree_[first].next;
            const glm::dvec3 apart = twiceCentre(second) - twiceCentre(first), size = glm::abs(apart);
            const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
            constexpr int kBits[]{0, 2, 1};
            const bool backward = (order >> kBits[axis] & 1) != 0;
            const bool swapped = (apart[axis] < 0) != backward;
            add(order, swapped ? second : first);
            add(order, swapped ? first : second);
        }
        out_[at].next = uint32_t(out_.size());
    }

private:
    glm::dvec3 twiceCentre(uint32_t node) const { return tree_[node].bounds.lo + tree_[node].bounds.hi; }

    std::span<const BoundingNode> tree_;
    std::vector<gpu::ObjectNode>& out_;
};

std::vector<gpu::Triangle> blocksOf(std::span<const Triangle> triangles) {
    std::vector<gpu::Triangle> blocks;
    blocks.reserve(triangles.size());
    for (const Triangle& t : triangles) blocks.push_back({t.corners[0], t.corners[1], t.corners[2], t.albedo});
    return blocks;
}

} // namespace

std::vector<gpu::ObjectNode> meshNodes(std::span<const Triangle> triangles) {
    std::vector<Bounds3> bounds;
    for (const Triangle& triangle : triangles) {
        Bounds3& of = bounds.emplace_back();
        for (const glm::dvec3 corner : triangle.corners) of.add({corner, corner});
    }
    const std::vector<BoundingNode> tree = boundingTree(bounds);
    std::vector<gpu::ObjectNode> nodes;
    const bool few = triangles.size() > gpu::kMostInAllOrders;
    nodes.reserve(tree.size() * (few ? gpu::kFewMeshOrders : gpu::kMeshOrders));
    for (uint32_t order = few ? gpu::kFewMeshOrders : 0; order < gpu::kMeshOrders && !tree.empty(); ++order)
        Ordered(tree, nodes).add(order);
    return nodes;
}

MeshBuffers::MeshBuffers(const gpu::Device& device, std::span<const Triangle> all) {
    fill(device, triangles, blocksOf(all), "triangles");
    const std::vector<gpu::ObjectNode> tree = meshNodes(all);
    fill(device, nodes, tree, "mesh nodes");
    if (!tree.empty()) bounds = {tree.front().lo, tree.front().hi};
}

} // namespace brume
