#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Opaque shadow map: per texel the height along to_light of the topmost box or sphere, -1e30 where there is none.
#include "shaders/shared/types.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) readonly buffer Objects { Opaque objects[]; };
layout(r32f, binding = 2) writeonly uniform image2D map;

#include "shaders/lib/objects.glsl"

void main() {
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, uvec2(tick.opaque_size)))) return;
    const vec2 at = mix(tick.opaque_lo, tick.opaque_hi, (vec2(gl_GlobalInvocationID.xy) + 0.5) / float(tick.opaque_size));
    float top = -1e30;
    for (uint i = 0; i < tick.opaque_count; ++i) {
        const Opaque o = objects[i];
        if (o.kind == kPlane) continue; // nothing lies below it
        const float reach = length(o.half_size) + 1;
        const float start = dot(tick.to_light, o.centre) + reach; // a ray from just above the object
        vec3 n;
        const float t = hitObject(o, at.x * tick.light_x + at.y * tick.light_y + start * tick.to_light, -tick.to_light, n);
        if (t < kMiss) top = max(top, start - t);
    }
    imageStore(map, ivec2(gl_GlobalInvocationID.xy), vec4(top));
}
