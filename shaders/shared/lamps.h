// Points and spots whose light rays of a field hold. One text, compiled as C++ and as GLSL.
#ifndef BRUME_SHARED_LAMPS_H
#define BRUME_SHARED_LAMPS_H

#include "real.h"

BRUME_PHYSICS_BEGIN

const uint kMostLocalLights = 1024u;

// True if neighbouring rays and slabs tell the light that particles scatter of a lamp: where it varies most they are at
// most `most` of the length apart in which it varies. smooth_length: LocalLight::smooth_length, m; depth: view depth of
// the lamp, m; apart: distance of rays, m per m of view depth; slab: thickness of slabs, m of view depth.
BRUME_FN bool raysHold(real smooth_length, real depth, real apart, real slab, real most) {
    // There the medium is as far behind the lamp as beside it.
    const real there = max(depth, real(0)) + smooth_length;
    return smooth_length > 0 && max(apart * there, slab) <= most * smooth_length;
}

BRUME_PHYSICS_END

#endif
