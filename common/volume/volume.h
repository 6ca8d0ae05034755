// Volumes: extinction at the voxels of a lattice, from files of the format NRRD. Between voxels it is trilinear, and 0
// beyond the outermost.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "common/ply/ply.h"

namespace brume {

struct Volume {
    glm::uvec3 size{0};             // voxels along x, y, z
    glm::dvec3 origin{0};           // m, of the middle of voxel (0, 0, 0)
    double spacing = 1;             // m
    std::vector<float> extinction;  // 1/m; x fastest, then y
    std::vector<std::string> notes; // one line each: what was left out, or merged

    // Nodes of bricks of eight a side that hold it with a rim of nothing, as methods read it.
    static constexpr uint32_t kRimBefore = 2, kRimBehind = 3, kBrick = 8;
    glm::uvec3 bricks() const { return (size + kRimBefore + kRimBehind + kBrick - 1u) / kBrick; }
    uint64_t nodes() const { return uint64_t(bricks().x) * bricks().y * bricks().z * kBrick * kBrick * kBrick; }

    float at(glm::ivec3 voxel) const { // 0 outside
        if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, glm::ivec3(size))))
            return 0;
        return extinction[(size_t(voxel.z) * size.y + size_t(voxel.y)) * size.x + size_t(voxel.x)];
    }
};

// Attached data of three dimensions, encoding raw or gzip, of any scalar type and either byte order. Values are
// extinctions per unit of length; whole numbers are parts of their type's largest. Voxels have to be cubes along the
// file's axes. A volume of more than `most` nodes is halved until it has fewer: each voxel then is the mean of eight.
// Throws SceneError, one line, for a file that cannot be read or is not such a one.
Volume loadVolume(const std::filesystem::path& file, const PlyFrame& frame, uint64_t most);
Volume parseVolume(std::string_view bytes, const std::string& name, const PlyFrame& frame, uint64_t most);

// True: the bytes begin as a NRRD file does.
bool isNrrd(std::string_view bytes);
// Where the voxels of a file's bytes are, in its unit; `count` is their number. Throws SceneError as parseVolume().
PlyExtent volumeExtentOf(std::string_view bytes, const std::string& name, const std::string& up);

} // namespace brume
