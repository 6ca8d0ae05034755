#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Background, per eye: sky and opaque objects behind the medium.
#include "shaders/shared/types.h"

layout(local_size_x = 8, local_size_y = 8) in;

#include "shaders/blocks/eye.glsl"
layout(rgba32f) writeonly uniform image2D radiance;
layout(r32f) writeonly uniform image2D view_depth;

#include "shaders/lib/background.glsl"
#include "shaders/lib/spread.glsl"

void main() {
    const uvec2 at = spreadInvocation().xy;
    if (any(greaterThanEqual(at, eye.size))) return;
    float depth;
    const vec3 colour = background(vec2(at) + 0.5, depth);
    imageStore(radiance, ivec2(at), vec4(colour, 1));
    imageStore(view_depth, ivec2(at), vec4(depth));
}
