// Lines through voxels, between which values are trilinear. A voxel is 1 wide. Directions have unit length.
#pragma once

#include <limits>
#include <span>

#include <glm/glm.hpp>

#include "tools/import/voxels.h"

namespace brume::volumes {

// Of a line, by the distance from its point `through`; empty unless from < to.
struct Part {
    double from = -std::numeric_limits<double>::max(), to = std::numeric_limits<double>::max();
};

// What lies in the box of all cells that have a corner above 0.
Part partWithin(const Voxels& voxels, glm::dvec3 through, glm::dvec3 toward);

// The integral of the interpolated values along a part of a line. `of`: values beside voxels.values().
double integralAlong(const Voxels& voxels, std::span<const float> of, glm::dvec3 through, glm::dvec3 toward, Part part);
// Of the voxels' own values along the whole line.
double integralAlong(const Voxels& voxels, glm::dvec3 through, glm::dvec3 toward);

// A direction at right angles to another one.
glm::dvec3 acrossOf(glm::dvec3 toward);

} // namespace brume::volumes
