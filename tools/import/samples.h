// Volumes made by arithmetic, to measure and to test with.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "tools/import/voxels.h"

namespace brume::import {

// Voxels of the box [lo, hi] where `value` is above `least`; the others are 0.
Voxels sampled(glm::ivec3 lo, glm::ivec3 hi, float least, const std::function<float(glm::ivec3)>& value);

// A Gaussian ball of extinction.
struct Ball {
    glm::dvec3 centre;
    double deviation, peak;
};
// What balls add up to at the voxels' centres; lengths are in voxels. Voxels below `least` are left out.
Voxels rasterised(std::span<const Ball> balls, float least);

// Noise of several octaves in [0, 1], smooth, the same on all machines. One period is the largest octave's.
float fractalNoise(glm::dvec3 at, int octaves, uint64_t seed);

} // namespace brume::import
