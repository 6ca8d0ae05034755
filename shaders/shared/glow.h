// Light that the medium throws on surfaces, as nodes around it hold it: net flux and fluence.
#ifndef BRUME_SHARED_GLOW_H
#define BRUME_SHARED_GLOW_H

#include "real.h"

#ifdef __cplusplus
#include <cstdint>
namespace brume::gpu {
using uint = uint32_t;
#endif
const uint kLampBlocks = 4u; // blocks of cells along each side of the medium's bounds
const uint kLamps = kLampBlocks * kLampBlocks * kLampBlocks;
const uint kGlowSide = 24u;    // nodes along each side of what they cover
const float kGlowReach = 1.5f; // distance of the outermost nodes from the middle, in sizes of the medium's bounds
#ifdef __cplusplus
} // namespace brume::gpu
#endif

BRUME_PHYSICS_BEGIN

// Irradiance of a surface of unit normal n by light of this fluence and net flux. Light whose directions agree comes
// from the flux's direction, the rest from all sides. Exact for one direction, and for even light.
BRUME_FN real irradianceOf(real fluence, BRUME_VEC3 flux, BRUME_VEC3 n) {
    const real directed = min(length(flux), fluence);
    return real(0.25) * (fluence - directed) + max(-dot(flux, n), real(0));
}

BRUME_PHYSICS_END

#endif
