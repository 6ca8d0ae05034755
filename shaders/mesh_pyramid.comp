#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Least and largest heights of the height map of meshes, in squares of 2^level texels a side, of one level from those
// of the level before. A lane makes a square.
#include "shaders/shared/types.h"

layout(local_size_x = 8, local_size_y = 8) in;

#include "shaders/blocks/tick.glsl"
layout(scalar) buffer MeshPyramid { vec2 mesh_pyramid[]; };
layout(push_constant, scalar) uniform Push { uint level; } push;

#include "shaders/lib/mesh_pyramid.glsl"

void main() {
    const uint side = tick.mesh_size >> push.level;
    const uvec2 square = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(square, uvec2(side)))) return;
    vec2 heights = vec2(1e30, -1e30);
    for (uint i = 0; i < 4; ++i) {
        const vec2 part = meshHeights(push.level - 1, ivec2(2 * square + uvec2(i & 1, i >> 1)));
        heights = vec2(min(heights.x, part.x), max(heights.y, part.y));
    }
    mesh_pyramid[firstSquare(push.level) + square.y * side + square.x] = heights;
}
