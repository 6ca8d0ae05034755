// Gaussians as voxels.
#pragma once

#include <optional>
#include <span>

#include <glm/glm.hpp>

#include "tools/import/voxels.h"

namespace brume::volumes {

// A ball, or an ellipsoid, whose three semi-axes are at right angles. Its value is peak exp(-|y|^2 / 2), where y is the
// place from its centre, over the deviation and, of an ellipsoid, in units of its semi-axes (shared/ellipsoid.h).
struct Gaussian {
    glm::dvec3 centre; // voxels, as the deviation
    double deviation, peak;
    glm::vec3 albedo{1};
    std::optional<glm::dmat3> axes = {}; // over the deviation; none: a ball
};
using Ball = Gaussian; // without axes

struct Raster {
    Voxels voxels;                 // what the Gaussians add up to at the voxels' centres
    std::vector<glm::vec3> albedo; // beside them, the mean weighted by the Gaussians' parts; empty unless asked for
};

// What is below `least` is left out. Precondition: centres are finite and between -kFarthest / 2 and kFarthest / 2.
Raster rasterised(std::span<const Gaussian> gaussians, float least, bool coloured = false);

// True: the Gaussians reach up to `most` blocks, each of kInBlock voxels. It takes memory for no more.
bool fits(std::span<const Gaussian> gaussians, uint64_t most);

// The sum over all of space, in voxels' volumes.
double massOf(const Gaussian& gaussian);

} // namespace brume::volumes
