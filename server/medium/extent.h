// What a tick's particles are as a whole: where they end, how fine they are. From it follow the resolutions that methods work at.
#pragma once

#include <span>

#include "shaders/shared/types.h"

namespace brume {

struct MediumExtent {
    glm::vec3 lo{0}, hi{0}; // m, world space, with every particle's support; lo = hi = 0 when nothing is there
    // m: the standard deviation whose interpolation error is that of the medium, (sum of m s^-4 / sum of m)^(-1/4) over the
    // particles' own, m = their optical mass: a few thin small ones do not make the whole scene fine.
    float deviation = 1;
    bool one_albedo = true; // of all particles
    glm::vec3 albedo{1};    // the first one's
};

// `cut` as gpu::Tick::cut.
MediumExtent mediumExtent(std::span<const gpu::Particle> particles, float falloff, float cut);

// View depths (m) between which its bounds lie, from `eye` along `forward` (unit); negative ones are behind the eye.
struct DepthRange {
    float near = 0, far = 0;
};
DepthRange depthRange(const MediumExtent& extent, glm::vec3 eye, glm::vec3 forward);

} // namespace brume
