// Volumes made by arithmetic, to measure and to test with.
#pragma once

#include <cstdint>
#include <functional>

#include <glm/glm.hpp>

#include "tools/import/voxels.h"

namespace brume::volumes {

// Voxels of the box [lo, hi] where `value` is above `least`; the others are 0.
Voxels sampled(glm::ivec3 lo, glm::ivec3 hi, float least, const std::function<float(glm::ivec3)>& value);

// Noise of several octaves in [0, 1], smooth, the same on all machines. One period is the largest octave's.
float fractalNoise(glm::dvec3 at, int octaves, uint64_t seed);

} // namespace brume::volumes
