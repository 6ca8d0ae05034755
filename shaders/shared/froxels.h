// Froxels: the cells of an eye's view volume. Rays are `pixels` apart, slices grow with their distance. One text,
// compiled as C++ and as GLSL (scalar layout).
#ifndef BRUME_SHARED_FROXELS_H
#define BRUME_SHARED_FROXELS_H

#include "types.h"

#ifdef __cplusplus
namespace brume::gpu {
#endif

// How objects shadow the medium (FroxelSettings::shadows).
const uint kShadowsByMap = 0u; // of the sun; rays for points and spots, which have no map
const uint kShadowsByRay = 1u;
const uint kShadowsByGrid = 2u;
const uint kShadowsHybrid = 3u; // frustum near the eye, grid behind it
const uint kShadowsNone = 4u;   // not asked: what shadows cost is the difference

// A band of rows of rays. Ray (x, y) passes through the middle of pixel
// pixels * (x, y).
struct FroxelGrid {
    uvec2 rays;     // columns, and rows of the band
    uint first_row; // of the band, in rows of rays
    uint pixels;    // between neighbouring rays
    uint slices;
    float near; // m of view depth: face 0
    float unit; // m; face f lies at near + unit (2^(growth f) - 1)
    float growth;
    uint particles; // 1: the nodes hold particles; 0: there are none
};

// What an eye's last picture gives to its cells. Indices count vec4s of the eye's cells.
struct HistoryBlock {
    Eye eye;            // of that picture
    FroxelGrid froxels; // of that picture
    uint first;         // of its cells
    uint own;           // of the cells of the present picture
    uint known;         // 1: there was such a picture
    float part;         // of it that is kept
};

#ifdef __cplusplus
static_assert(sizeof(FroxelGrid) == 36);
} // namespace brume::gpu
#endif
#endif
