// Extent of a tick's medium: bounds, standard deviation and albedo of its particles. Methods derive their resolutions
// from it.
#pragma once

#include <span>

#include "shaders/shared/types.h"

namespace brume {

struct MediumExtent {
    glm::vec3 lo{0}, hi{0}; // m, world space, of all particles' supports; lo = hi = 0 without particles
    // m. The standard deviation of a single size of particles with the same interpolation error as the medium's: (sum
    // of m s^-4 / sum of m)^(-1/4), s: a particle's deviation, m: its optical mass. A few thin small particles hardly
    // change it.
    float deviation = 1;
    bool one_albedo = true; // True: all particles have the same albedo
    glm::vec3 albedo{1};    // the first particle's
};

// `cut`: gpu::Tick::cut. `corners`: true for particles that are corners of tetrahedra, which all count.
MediumExtent mediumExtent(std::span<const gpu::Particle> particles, float falloff, float cut, bool corners = false);

// View depths (m) of the medium's bounds, from `eye` along `forward` (unit). Negative depths are behind the eye.
struct DepthRange {
    float near = 0, far = 0;
};
DepthRange depthRange(const MediumExtent& extent, glm::vec3 eye, glm::vec3 forward);

} // namespace brume
