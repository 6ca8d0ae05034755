// What the passes of the shared shadow grid hand to each other: one text, compiled as C++ and as GLSL (scalar layout).
#ifndef BRUME_SHARED_SHADOW_GRID_H
#define BRUME_SHARED_SHADOW_GRID_H

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
namespace brume::gpu {
using uint = uint32_t;
using glm::uvec3;
using glm::vec3;
using glm::vec4;
#endif

const uint kShadowBrick = 8u;     // voxels along a side of a brick
const uint kMostShadowSlots = 8u; // lights that have shadows in the grid
const uint kMostShadowEyes = 64u; // with more of them all places count as seen
const uint kNoShadowSlot = 0xffffffffu;
const uint kLitVoxel = 254u;   // coverage of a voxel that is lit all over
const uint kSolidVoxel = 255u; // coverage of a voxel that lies in solids: it has no light to tell of
const float kSunAway = 1e5;    // m, how far a ray to the sun is followed

// A light of the grid.
struct ShadowSlot {
    vec3 to;     // of the sun the unit direction to it; of others their place
    uint local;  // 1: a point or a spot, 0: the sun
    vec3 bound;  // a ball that holds all it lights: its centre,
    float reach; // and its radius, m; 1e15 and more: all
};

struct ShadowGridBlock {
    vec3 origin; // m, where voxel (0, 0, 0) begins
    float voxel; // m
    uvec3 bricks;
    uint stride;   // bytes of a voxel
    uint slots;    // lights in use
    uint linear;   // 1: the look-up interpolates between 8 voxels; 0: it takes the nearest
    uint coverage; // 1: a byte for each light and voxel; 0: a bit
    uint sun;      // the sun's slot, or kNoShadowSlot
    ShadowSlot lights[8];
};

// An eye's field of view: six planes (normal, offset), inside is where normal . x + offset >= 0.
struct ShadowEye {
    vec4 planes[6];
};

struct ShadowGridPush {
    uint version; // of lights and objects; 0: of voxels that were never made
    uint layer;   // 0 or 1: of old layers of voxels those of even or odd z are made; 2: both
    uint eyes;    // more than kMostShadowEyes: all places count as seen
};

#ifdef __cplusplus
static_assert(sizeof(ShadowSlot) == 32 && sizeof(ShadowGridBlock) == 48 + 8 * 32 && sizeof(ShadowEye) == 96);
static_assert(kMostShadowSlots == 8 && offsetof(ShadowGridBlock, lights) == 48);
} // namespace brume::gpu
#endif
#endif
