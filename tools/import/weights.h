// What a Gaussian's weights at voxels gather.
#pragma once

#include <glm/glm.hpp>

namespace brume::volumes {

constexpr double kLeastDeviation = 0.35; // voxels; a narrower Gaussian falls between the voxels' centres

// What voxels have, weighted by a Gaussian: the sum, and its moments about the Gaussian's middle.
struct Moments {
    double mass = 0;
    glm::dvec3 first{0};
    glm::dmat3 second{0}; // of balls the diagonal alone
};

} // namespace brume::volumes
