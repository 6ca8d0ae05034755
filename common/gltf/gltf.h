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
    glm::vec3 albedo;      // base colour: its factor, texture and the mean of the vertex colours, linear, in [0, 1]
};

struct Gltf {
    std::vector<GltfTriangle> triangles; // of the file's scene; at least one
    std::vector<std::string> told;       // a line for each kind of thing that was left out; few and short
};

// Reads the file, and buffers and images beside it. Skins and morph targets are in the pose that the file has. Throws
// SceneError, one line, for a file that cannot be read, is no such glTF, requires an extension that moves vertices or
// holds them, or has no triangle or more than `most` of them.
Gltf loadGltf(const std::filesystem::path& file, size_t most);

// Reads the bytes of a file from memory; messages call it `name`, and what it names lies in `folder`.
Gltf parseGltf(std::string_view bytes, const std::string& name, const std::filesystem::path& folder, size_t most);

} // namespace brume
