// MeshBuffers: the triangles of a scene's meshes and their tree in device memory.
#pragma once

#include <span>
#include <vector>

#include "common/bounding_tree.h"
#include "common/scene.h"
#include "server/gpu/resource.h"
#include "shaders/shared/types.h"

namespace brume {

// The tree of triangles in gpu::kMeshOrders orders, of many in gpu::kFewMeshOrders, one after the other. Its boxes are
// rounded outward.
std::vector<gpu::ObjectNode> meshNodes(std::span<const Triangle> triangles);

struct MeshBuffers {
    MeshBuffers(const gpu::Device& device, std::span<const Triangle> triangles);

    gpu::Buffer triangles; // gpu::Triangle[]
    gpu::Buffer nodes;     // gpu::ObjectNode[]: meshNodes()
    Bounds3 bounds;        // m, of all triangles
};

} // namespace brume
