#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Opaque shadow map: the rectangle that a box or a sphere covers, seen from the light.
#include "shaders/shared/types.h"

#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
layout(push_constant, scalar) uniform Push { uint object; } push;

#include "shaders/lib/objects.glsl"

vec2 acrossLight(vec3 v) { return vec2(dot(tick.map.x, v), dot(tick.map.y, v)); }

void main() {
    const Opaque o = objects[push.object];
    vec2 reach = vec2(o.half_size.x);
    if (o.kind == kBox)
        reach = abs(acrossLight(fromObject(o, vec3(o.half_size.x, 0, 0)))) +
                abs(acrossLight(vec3(0, o.half_size.y, 0))) +
                abs(acrossLight(fromObject(o, vec3(0, 0, o.half_size.z))));
    const vec2 size = tick.map.opaque_hi - tick.map.opaque_lo,
               corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2 - 1;
    // One texel more, so that rounding omits none.
    const vec2 at = acrossLight(o.centre) + corner * (reach + size / float(tick.map.opaque_size));
    gl_Position = vec4((at - tick.map.opaque_lo) / size * 2 - 1, 0, 1);
}
