#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Six fluxes: those of a grid begin with what the next coarser one, which lies behind it, has, linearly between its
// cells. A lane is a cell.
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 2) buffer FluxesBlock { float fluxes[]; };

#include "shaders/lib/flux_grid.glsl"

void main() {
    if (gl_GlobalInvocationID.x >= push.side * push.side * push.side) return;
    const uvec3 place = placeOf(gl_GlobalInvocationID.x);
    const uint coarser = push.side / 2, first = push.first + push.side * push.side * push.side;
    // Each cell's middle is a quarter of a coarse cell away from that of the coarse cell around it.
    const uvec3 own = place / 2;
    const ivec3 step = ivec3(place & 1) * 2 - 1;
    const uvec3 next = uvec3(clamp(ivec3(own) + step, ivec3(0), ivec3(coarser) - 1));
    for (uint c = 0; c < push.channels; ++c) {
        float sum[6] = float[6](0, 0, 0, 0, 0, 0);
        for (uint i = 0; i < 8; ++i) {
            const bvec3 away = bvec3(i & 1, i >> 1 & 1, i >> 2);
            const vec3 part = mix(vec3(0.75), vec3(0.25), away);
            const uint from = fluxesAt(c, first + cellAt(mix(own, next, away), coarser));
            for (uint k = 0; k < 6; ++k) sum[k] += part.x * part.y * part.z * fluxes[from + k];
        }
        const uint to = fluxesAt(c, push.first + cellAt(place, push.side));
        for (uint k = 0; k < 6; ++k) fluxes[to + k] = sum[k];
    }
}
