// The grids of cells that the six fluxes pass (shared/multiple.h), in light space: x and y along LightMap::x and y, z
// the way that the sun's light goes.
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/constants.h"
#include "shaders/shared/multiple.h"

layout(constant_id = kIdCellMatter) const bool kCellMatter = false; // True: cells have their own albedo

layout(push_constant, scalar) uniform Push {
    uint side;     // cells along each side of this grid
    uint first;    // index of its first cell, in all grids
    uint all;      // number of cells of all grids
    uint channels; // 1, or 3: red, green and blue
    uint parity;   // of x + y + z: cells that the first half step computes
    uint half_steps;
    uint last;     // 1: the fluence is written
    uint surfaces; // number of boxes and spheres that send light
    uint parts;    // along each side of a surface; 0: surfaces send no light
} push;

// Light of surfaces in the middle of a cell of the second grid, for E = 1.
struct SurfaceLight {
    float fluence; // as if no medium dimmed it; negative within an object
    float depth;   // optical depth by which the medium dims all of it
    vec3 mean_way; // net flux over fluence
};

vec3 cellSize() { return (tick.map.hi - tick.map.lo) / float(push.side); } // m

uint cellAt(uvec3 place, uint side) { return (place.z * side + place.y) * side + place.x; }
// A cell's numbers: its extinction, 1/m, and two of each channel: extinction times firstScattered(), and the
// same times the part by which that light goes on the sun's way, in [-1, 1]. With kCellMatter its scattering, 1/m, in
// each channel follows.
uint numbersOfCell() { return 1 + (kCellMatter ? 3 : 2) * push.channels; }
uint numbersAt(uint cell) { return cell * numbersOfCell(); }
uint scatteringAt(uint channel, uint cell) { return numbersAt(cell) + 1 + 2 * push.channels + channel; }

// The scaled medium of a cell in a channel: part of the extinction that dims the beam, and albedo. own: the albedo of
// the cell's particles, which counts with kCellMatter.
vec2 scaledMedium(uint channel, float own) {
    const float passed = tick.multiple.passed[channel], scaled = tick.multiple.albedo[channel];
    if (!kCellMatter) return vec2(passed, scaled);
    const float straight = straightOf(passed, scaled);
    return vec2(passedPart(own, straight), scaledAlbedo(own, straight));
}

// Index of the six fluxes that leave a cell: up and down.
uint fluxesAt(uint channel, uint cell) { return (channel * push.all + cell) * 6; }

// The cell of a lane, of all that the grid has.
uvec3 placeOf(uint lane) {
    return uvec3(lane % push.side, lane / push.side % push.side, lane / (push.side * push.side));
}

// Linear interpolation between coarser cells, of which there are `side` along each side: the weight of neighbour `i` of
// eight, and its index. Each cell's middle is a quarter of a coarser one away from that of the coarser cell around it.
float coarseNeighbour(uvec3 place, uint side, uint i, out uint at) {
    const uvec3 own = place / 2;
    const ivec3 step = ivec3(place & 1) * 2 - 1;
    const uvec3 next = uvec3(clamp(ivec3(own) + step, ivec3(0), ivec3(side) - 1));
    const bvec3 away = bvec3(i & 1, i >> 1 & 1, i >> 2);
    const vec3 part = mix(vec3(0.75), vec3(0.25), away);
    at = cellAt(mix(own, next, away), side);
    return part.x * part.y * part.z;
}
