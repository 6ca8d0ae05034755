#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Opaque shadow map: height along to_light of the top of a box or sphere. Blending keeps the largest.
#include "shaders/shared/types.h"

#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
layout(push_constant, scalar) uniform Push { uint object; } push;

layout(location = 0) out float height;

#include "shaders/lib/objects.glsl"

void main() {
    const Opaque o = objects[push.object];
    const vec2 at = mix(tick.map.opaque_lo, tick.map.opaque_hi, gl_FragCoord.xy / float(tick.map.opaque_size));
    const float start = dot(tick.sun.to_light, o.centre) + length(o.half_size) + 1; // a ray from just above the object
    vec3 n;
    const float t =
        hitObject(o, at.x * tick.map.x + at.y * tick.map.y + start * tick.sun.to_light, -tick.sun.to_light, n);
    height = t < kMiss ? start - t : -1e30;
}
