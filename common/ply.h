// Point clouds from PLY files: ASCII and binary little-endian, version 1.0.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace brume {

// The optional lists are empty, or as long as `position`.
struct PointCloud {
    std::vector<glm::vec3> position; // m
    std::vector<float> scale;        // m, centre to vertex of a particle's tetrahedron
    std::vector<float> sigma_t;      // 1/m, extinction at a particle's centre
    std::vector<glm::vec3> albedo;   // linear, in [0, 1]; a uchar is divided by 255
    size_t dropped = 0;              // number of points left out, since a number is not finite or out of range
};

// Reads element `vertex` with x y z and, if present, scale, sigma_t, red green blue; everything else is skipped.
// Positions are read as doubles, and `origin` (m) is subtracted before they become floats. Points that then lie
// beyond limits::kPlace are dropped. Logs how many points were dropped. Throws SceneError for a file that cannot be
// read, is not such a PLY, ends early, or has no usable point.
PointCloud loadPly(const std::filesystem::path& file, glm::dvec3 origin = glm::dvec3(0));

// Reads the bytes of a PLY file from memory; messages call the file `name`.
PointCloud parsePly(std::string_view bytes, const std::string& name, glm::dvec3 origin = glm::dvec3(0));

} // namespace brume
