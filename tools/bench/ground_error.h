// Measures the shadow that a union of balls throws on surfaces, apart from the medium's own picture.
#pragma once

#include "tools/bench/stage.h"

namespace brume::bench {

// Of the part of the sun's light that the balls let through to what the pixels' rays hit first, at places that some
// ball shadows.
struct GroundError {
    double rms = 0;    // of the difference from the reference
    double bias = 0;   // its mean; positive is too bright
    double places = 0; // how many
};
// The picture is drawn anew with a black medium, so that only surfaces light it. The medium's transmittance divides
// out. Throws SceneError unless the medium is a union of balls.
GroundError groundError(const gpu::Device& device, const Case& wanted, glm::uvec2 size, uint32_t ticks);

} // namespace brume::bench
