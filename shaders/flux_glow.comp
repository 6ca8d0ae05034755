#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Light of the medium's lamps at nodes around it: net flux and fluence. A lane is a node.
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/tick.glsl"
#include "shaders/lib/flux_grid.glsl"
#include "shaders/lib/flux_lamps.glsl"
layout(scalar) readonly buffer Lamps { FluxLamp lamps[]; };
layout(scalar) writeonly buffer Glow { vec4 glow[]; }; // [channel][z][y][x]

void main() {
    const uint node = gl_GlobalInvocationID.x, all = kGlowSide * kGlowSide * kGlowSide;
    if (node >= all) return;
    const vec3 part = vec3(node % kGlowSide, node / kGlowSide % kGlowSide, node / (kGlowSide * kGlowSide)) *
                          (2 / float(kGlowSide - 1)) -
                      1;
    const vec3 x = part * kGlowReach * (tick.map.hi - tick.map.lo);
    vec4 sums[3] = vec4[](vec4(0), vec4(0), vec4(0));
    [[dont_unroll]] for (uint i = 0; i < kLamps; ++i) {
        const FluxLamp lamp = lamps[i];
        const vec3 way = x - lamp.place;
        // An even ball of this mean square: outside it shines as a point (Gauss), within it ever less directed.
        const float square = dot(way, way), outside = max(max(square, lamp.square * 5 / 3), 1e-12);
        const vec3 unit = way * inversesqrt(max(square, 1e-12));
        const vec4 there = throughToward(lamp, unit) / (4 * 3.14159265 * outside) * vec4(way * inversesqrt(outside), 1);
        for (uint c = 0; c < push.channels; ++c) sums[c] += lamp.power[c] * there;
    }
    for (uint c = 0; c < push.channels; ++c) glow[c * all + node] = sums[c];
}
