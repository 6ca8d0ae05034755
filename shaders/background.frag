#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Background, per eye, as a draw over the whole picture: sky and opaque objects behind the medium. CPU drivers write
// to targets several times faster than to storage images; GPUs use background.comp, which gives the same picture.
#include "shaders/shared/types.h"

#include "shaders/blocks/eye.glsl"

layout(location = 0) out vec4 radiance;
layout(location = 1) out float view_depth;

#include "shaders/lib/background.glsl"

void main() {
    const vec3 colour = background(gl_FragCoord.xy, view_depth);
    radiance = vec4(colour, 1);
}
