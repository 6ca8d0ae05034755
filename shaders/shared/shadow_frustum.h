// The shadow frusta of all eyes: one text, compiled as C++ and as GLSL (scalar layout).
#ifndef BRUME_SHARED_SHADOW_FRUSTUM_H
#define BRUME_SHARED_SHADOW_FRUSTUM_H

#include "shaders/shared/types.h"

#ifdef __cplusplus
namespace brume::gpu {
#endif

// Coarse froxels before one eye: a byte each, a bit for each slot of the shadow grid, [slice][row][column]. The middle
// of slice s lies at the view depth near + unit * (exp2(growth * (s + 0.5)) - 1).
struct ShadowFrustum {
    Eye eye;
    uint first;   // index of its first word of four bytes
    uint columns; // a multiple of 4
    uint rows;
    uint slices;
    uint pixels; // along a side of a froxel
    float near;  // m
    float unit;  // m
    float growth;
};

#ifdef __cplusplus
static_assert(sizeof(ShadowFrustum) == sizeof(Eye) + 32);
} // namespace brume::gpu
#endif
#endif
