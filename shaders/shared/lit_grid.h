// LitGrid: nodes of world space that keep the light which arrives there. One text, compiled as C++ and as GLSL (scalar
// layout).
#ifndef BRUME_SHARED_LIT_GRID_H
#define BRUME_SHARED_LIT_GRID_H

#include "types.h"

#ifdef __cplusplus
namespace brume::gpu {
#endif

// What nodes keep of points and spots, as numbers in a row:
const uint kKeepsLights = 0u;  // one number for each light: the part of its light that arrives (0 ... 1)
const uint kKeepsColours = 1u; // three: the part of all light that arrives, in red, green and blue (0 ... 1)
// Twelve, four for each of red, green and blue: the sum of unit directions of light times its fluence, and the fluence
// (W/m^2).
const uint kKeepsFluence = 2u;
const uint kMostKeptLights = 16u; // lights of kKeepsLights, at most

// Nodes at origin + spacing * (0, 1, 2 ...), in bricks of kSlabTile a side. Each has the part of the sun's light that
// arrives (0 ... 1), and what LitGridShape::keeps says of points and spots.
// Lights nearer than `near` spacings are left out, and those up to twice as far in part: they are added exactly.
struct LitGridShape {
    vec3 origin;   // m
    float spacing; // m
    uvec3 bricks;
    uint particles; // 1: only bricks with particles are known, and the medium's nodes lie where these do
    float near;     // spacings, RadianceSettings::near; 0: all light is kept
    uint keeps;
    uint numbers; // that a node keeps of points and spots
};

#ifdef __cplusplus
static_assert(sizeof(LitGridShape) == 44);
} // namespace brume::gpu
#endif
#endif
