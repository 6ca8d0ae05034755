#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Six fluxes: those of a grid begin with what the next coarser one, which lies behind it, has, linearly between its
// cells. A lane is a cell.
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

layout(scalar) buffer FluxesBlock { float fluxes[]; };

#include "shaders/lib/flux_grid.glsl"

void main() {
    if (gl_GlobalInvocationID.x >= push.side * push.side * push.side) return;
    const uvec3 place = placeOf(gl_GlobalInvocationID.x);
    const uint coarser = push.side / 2, first = push.first + push.side * push.side * push.side;
    for (uint c = 0; c < push.channels; ++c) {
        float sum[6] = float[6](0, 0, 0, 0, 0, 0);
        for (uint i = 0; i < 8; ++i) {
            uint at;
            const float part = coarseNeighbour(place, coarser, i, at);
            const uint from = fluxesAt(c, first + at);
            for (uint k = 0; k < 6; ++k) sum[k] += part * fluxes[from + k];
        }
        const uint to = fluxesAt(c, push.first + cellAt(place, push.side));
        for (uint k = 0; k < 6; ++k) fluxes[to + k] = sum[k];
    }
}
