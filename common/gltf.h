// Triangles of glTF 2.0 files, .glb and .gltf.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace brume {

struct GltfTriangle {
    glm::dvec3 corners[3]; // in the file's units, with all its nodes' transforms
    glm::vec3 albedo;      // the material's base colour factor, linear, in [0, 1]
};

struct Gltf {
    std::vector<GltfTriangle> triangles; // of the file's scene; at least one
    bool textured = false;               // True: a material has a base colour texture, which is not read
};

// Reads the file and the buffers beside it. Triangles are read alone, without skins; animations are ignored. Throws
// SceneError for a file that cannot be read, is no such glTF, or has no triangle or more than `most` of them.
Gltf loadGltf(const std::filesystem::path& file, size_t most);

// Reads the bytes of a file from memory; messages call it `name`, and its buffers lie in `folder`.
Gltf parseGltf(std::string_view bytes, const std::string& name, const std::filesystem::path& folder, size_t most);

} // namespace brume
