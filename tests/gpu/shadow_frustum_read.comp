#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Looks up all froxels of one eye's shadow frustum: bits of slots [slice][row][column].
#include "shaders/shared/shadow_frustum.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer Frusta { ShadowFrustum shadow_frusta[]; };
layout(scalar) readonly buffer Froxels { uint shadow_froxels[]; };
layout(scalar) writeonly buffer Lit { uint lit[]; };

layout(push_constant, scalar) uniform Push { uint view, columns; } push;

#include "shaders/lib/shadow_frustum.glsl"

void main() {
    const uint i = gl_GlobalInvocationID.x, rows = shadow_frusta[push.view].rows;
    if (i >= push.columns * rows * shadow_frusta[push.view].slices) return;
    uvec2 pixel = uvec2(i % push.columns, i / push.columns % rows) * shadow_frusta[push.view].pixels + 1;
    if (i % push.columns == push.columns - 1) pixel.x += 1000; // beyond the picture
    uint bits = 0;
    for (uint slot = 0; slot < 8; ++slot)
        bits |= uint(litInFrustum(push.view, slot, pixel, i / (push.columns * rows))) << slot;
    lit[i] = bits;
}
