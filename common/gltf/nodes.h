// Nodes: where the meshes of a glTF file's scene stand.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "common/gltf/file.h"

namespace brume::gltf {

struct MeshNode {
    const Json& node; // null: a mesh of a file without nodes
    const Json& mesh;
    std::vector<glm::dmat4> worlds; // world from the node; several with EXT_mesh_gpu_instancing
    // Of a node with a skin: for each joint, world from the mesh. Empty: no skin, or one that cannot be applied.
    std::span<const glm::dmat4> joints;
    // Of a node with a skin. True: another one without has the same mesh at the same place.
    bool stands_unskinned = false;
};

// Calls `use` for each node with a mesh in the file's scene, but for those that are hidden. Of a file without scenes
// all nodes are taken, of one without nodes all meshes. Copies by EXT_mesh_gpu_instancing may be `most` in all.
void forEachMesh(File& file, size_t most, const std::function<void(const MeshNode&)>& use);

} // namespace brume::gltf
