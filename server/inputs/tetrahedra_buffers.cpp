#include "server/inputs/tetrahedra_buffers.h"

#include <algorithm>
#include <utility>

#include "server/inputs/objects.h"
#include "server/inputs/on_device.h"

namespace brume {
TetrahedraBuffers::TetrahedraBuffers(const gpu::Device& device, std::shared_ptr<const Tetrahedra> mesh)
    : mesh_(std::move(mesh)), tree_(mesh_->tree) {
    std::vector<gpu::Tetrahedron> blocks;
    for (size_t i = 0; i < mesh_->corners.size(); ++i) blocks.push_back({mesh_->corners[i], mesh_->neighbours[i]});
    cells = onDevice(device, blocks, "tetrahedra");
    std::vector<gpu::TetrahedraFace> outside;
    for (const Tetrahedra::Face& face : mesh_->faces) outside.push_back({face.corners, face.cell});
    faces = onDevice(device, outside, "faces of tetrahedra");
    nodes = gpu::Buffer(device, tree_.size() * sizeof(gpu::ObjectNode), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                        gpu::Memory::upload, "nodes of tetrahedra");
}

void TetrahedraBuffers::follow(std::span<const gpu::Particle> corners) {
    float outside = 0, most = 0; // extinctions
    for (const gpu::Particle& corner : corners) most = std::max(most, corner.sigma_t);
    const std::span<gpu::ObjectNode> out = nodes.mapped<gpu::ObjectNode>(tree_.size());
    for (size_t i = tree_.size(); i-- > 0;) { // a node comes before what is in it
        BoundingNode& node = tree_[i];
        node.bounds = {};
        if (node.item == BoundingNode::kInner) {
            node.bounds.add(tree_[i + 1].bounds);
            node.bounds.add(tree_[tree_[i + 1].next].bounds);
        } else {
            const glm::uvec3 face = mesh_->faces[node.item].corners;
            for (int c = 0; c < 3; ++c) {
                const glm::dvec3 place = corners[face[c]].centre;
                node.bounds.add({place, place});
                outside = std::max(outside, corners[face[c]].sigma_t);
            }
        }
        out[i] = objectNode(node);
    }
    nodes.flush();
    hard_ = outside > kSoft * most;
}

} // namespace brume
