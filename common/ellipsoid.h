// Sizes of ellipsoids from their semi-axes, the longest of which has length 1.
#pragma once

#include <algorithm>

#include "shaders/shared/types.h"

namespace brume {

// The volume over that of a ball of the longest axis.
inline double partOfBall(const gpu::EllipsoidAxes& axes) {
    return double(glm::length(axes.a)) * double(glm::length(axes.b)) * double(glm::length(axes.c));
}

inline float shortestAxis(const gpu::EllipsoidAxes& axes) {
    return std::min({glm::length(axes.a), glm::length(axes.b), glm::length(axes.c)});
}

} // namespace brume
