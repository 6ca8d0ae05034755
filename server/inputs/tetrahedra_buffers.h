// TetrahedraBuffers: a mesh of tetrahedra in device memory, and the tree of its outside as its corners lie now.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/tetrahedra.h"
#include "server/gpu/resource.h"
#include "shaders/shared/tetrahedra.h"

namespace brume {

struct TetrahedraBuffers {
    TetrahedraBuffers(const gpu::Device& device, std::shared_ptr<const Tetrahedra> mesh);

    // Fits the tree to where the corners are. Precondition: nothing of it is on the device.
    void follow(std::span<const gpu::Particle> corners);
    uint32_t faceCount() const { return uint32_t(mesh_->faces.size()); }
    // True: the medium ends at once somewhere: a corner of the outside has more than kSoft of the largest extinction.
    bool isHard() const { return hard_; }

    gpu::Buffer cells; // gpu::Tetrahedron[]
    gpu::Buffer faces; // gpu::TetrahedraFace[]: of the outside
    gpu::Buffer nodes; // gpu::ObjectNode[]: their tree; boxes are rounded outward

private:
    std::shared_ptr<const Tetrahedra> mesh_;
    static constexpr float kSoft = 0.01f;
    std::vector<BoundingNode> tree_;
    bool hard_ = false;
};

} // namespace brume
