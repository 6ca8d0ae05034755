#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Height map of meshes under the sun: a corner of a triangle, seen from the light.
#include "shaders/shared/types.h"

#include "shaders/blocks/meshes.glsl"
#include "shaders/blocks/tick.glsl"

layout(location = 0) out float height_here; // along to_light

void main() {
    const Triangle triangle = triangles[gl_VertexIndex / 3];
    const uint corner = gl_VertexIndex % 3;
    const vec3 place = corner == 0 ? triangle.a : corner == 1 ? triangle.b : triangle.c;
    const vec2 across = vec2(dot(tick.map.x, place), dot(tick.map.y, place));
    gl_Position = vec4((across - tick.mesh_lo) / (tick.mesh_hi - tick.mesh_lo) * 2 - 1, 0, 1);
    height_here = dot(tick.sun.to_light, place);
}
