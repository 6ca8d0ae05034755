// Gaussian balls as voxels.
#pragma once

#include <span>

#include <glm/glm.hpp>

#include "tools/import/voxels.h"

namespace brume::volumes {

struct Ball {
    glm::dvec3 centre; // voxels, as the deviation
    double deviation, peak;
    glm::vec3 albedo{1};
};

struct Raster {
    Voxels voxels;                 // what the balls add up to at the voxels' centres
    std::vector<glm::vec3> albedo; // beside them, the mean weighted by the balls' parts; empty unless asked for
};

// What is below `least` is left out. Precondition: centres are finite and between -kFarthest / 2 and kFarthest / 2.
Raster rasterised(std::span<const Ball> balls, float least, bool coloured = false);

// The number of blocks that balls reach, each of kInBlock voxels.
uint64_t blocksOf(std::span<const Ball> balls);

} // namespace brume::volumes
