// A volume out of a VDB file, as a fit needs it. OpenVDB itself is used by volume_file.cpp alone.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "tools/import/voxels.h"

namespace brume::volumes {

inline constexpr uint64_t kMostVoxels = 256'000'000; // active ones; the fit takes some 30 bytes for each

// What a user can get wrong; one line.
class ImportError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct Volume {
    Voxels voxels{{}};
    glm::dmat3 turn{1};              // of the file's space from voxels: a voxel's width times a rotation
    glm::dvec3 origin{0};            // of voxel (0, 0, 0), in the file's space
    double width = 1;                // of a voxel, in the file's unit
    std::vector<glm::vec3> albedo;   // beside voxels.values(), or empty
    std::vector<glm::vec3> velocity; // the file's unit a second; beside voxels.values(), or empty
    std::vector<std::string> notes;  // for people: what was left out
};

struct VolumeWanted {
    std::string grid = "density";
    std::string albedo, velocity; // names of grids, "none", or empty for one of the usual names
};

// Throws ImportError for a file that is no VDB, has no such grid, no voxel above 0, too many of them, or ones that are
// no cubes.
Volume readVolume(const std::filesystem::path& file, const VolumeWanted& wanted);

// Writes grid `density` and, if they are there, grids `albedo` and `velocity`. Throws ImportError if it cannot.
void writeVolume(const std::filesystem::path& file, const Volume& volume);

} // namespace brume::volumes
