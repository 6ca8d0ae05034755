// The semi-axes of a file's points, as ellipsoids have them.
#pragma once

#include <string>

#include "common/ply/points.h"
#include "shaders/shared/types.h"

namespace brume::ply {

struct PointAxes {
    gpu::EllipsoidAxes axes; // orthogonal, the longest of length 1, none shorter than gpu::kLeastAxis
    double longest = 1;      // length of the longest in the file
    double volume = 1;       // the file's volume over that of `axes` times `longest`: below 1 if some were too short
    std::string problem;     // what is wrong with them, one line; empty: nothing
};

// Of point `i`, turned as its place is. Precondition: the points have axes.
PointAxes axesOf(const Points& points, size_t i, const std::string& up);

} // namespace brume::ply
