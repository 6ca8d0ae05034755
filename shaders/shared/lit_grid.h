// LitGrid: nodes of world space that keep the light which arrives there. One text, compiled as C++ and as GLSL (scalar
// layout).
#ifndef BRUME_SHARED_LIT_GRID_H
#define BRUME_SHARED_LIT_GRID_H

#include "types.h"

#ifdef __cplusplus
namespace brume::gpu {
#endif

// Nodes at origin + spacing * (0, 1, 2 ...), in bricks of kSlabTile a side. Each has the part of the sun's light that
// arrives (0 ... 1), and of points and spots a vec4 for red, green and blue: the sum of the unit directions of their
// light times its fluence, and the fluence (W/m^2).
// Lights nearer than `near` spacings are left out, and those up to twice as far in part: they are added exactly.
struct LitGridShape {
    vec3 origin;   // m
    float spacing; // m
    uvec3 bricks;
    uint particles; // 1: only bricks with particles are known, and the medium's nodes lie where these do
    float near;     // spacings, usually kNearNodes; 0: all light is kept
};

const float kNearNodes = 3.0f;

#ifdef __cplusplus
static_assert(sizeof(LitGridShape) == 36);
} // namespace brume::gpu
#endif
#endif
