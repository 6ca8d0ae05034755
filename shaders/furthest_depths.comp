#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Before the culling of scenes with opaque objects, per eye: how far the surfaces are from the eye, at most, in each
// tile of 16x16 pixels. What is farther in all tiles that it meets is hidden. A workgroup is a tile.
#include "shaders/shared/types.h"

layout(local_size_x = 8) in; // kPixelTile / 2

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(scalar) writeonly buffer Furthest { float furthest[]; }; // m, row by row

#include "shaders/lib/eye.glsl"

shared uint most; // bits of the largest view depth: not negative, so that they are ordered as the depths are

void main() {
    const ivec2 lo = ivec2(gl_WorkGroupID.xy * kPixelTile), last = ivec2(eye.size) - 1,
                hi = min(lo + int(kPixelTile) - 1, last);
    const vec2 texel = 1 / vec2(textureSize(view_depth, 0));
    const int x = lo.x + 2 * int(gl_LocalInvocationIndex);
    float depth = 0;
    for (int y = lo.y; x <= hi.x && y <= hi.y; y += 2) { // 2x2 pixels
        const vec4 z = textureGather(view_depth, vec2(min(ivec2(x, y), max(last, 1) - 1) + 1) * texel);
        depth = max(depth, max(max(z.x, z.y), max(z.z, z.w)));
    }
    if (gl_LocalInvocationIndex == 0) most = 0;
    barrier();
    atomicMax(most, floatBitsToUint(depth));
    barrier();
    if (gl_LocalInvocationIndex > 0) return;
    // The longest ray of unit view depth goes through a corner.
    const vec2 a = vec2(lo), b = vec2(lo) + float(kPixelTile);
    const float longest = max(max(length(rayDirection(a)), length(rayDirection(b))),
                              max(length(rayDirection(vec2(a.x, b.y))), length(rayDirection(vec2(b.x, a.y)))));
    furthest[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = uintBitsToFloat(most) * longest;
}
