// The triangles of a glTF file's meshes, where its nodes place them.
#pragma once

#include <vector>

#include "common/gltf/file.h"
#include "common/gltf/gltf.h"

namespace brume::gltf {

// At most `most`; of those that are left out the file's `told` has a line.
std::vector<GltfTriangle> trianglesOf(File& file, size_t most);

} // namespace brume::gltf
