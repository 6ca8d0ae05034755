#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Per viewer: the sky and the opaque objects, lit by the light through the medium; the view depth of what a pixel's centre hits.
// Edges are smoothed with four rays where a pixel's corners hit different objects.
#include "shaders/shared/types.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) uniform EyeBlock { Eye eye; };
layout(scalar, binding = 2) readonly buffer Objects { Opaque objects[]; };
layout(binding = 3) uniform sampler2DArray shadow_volume;
layout(binding = 4) uniform sampler2D opaque_shadow;
layout(rgba32f, binding = 5) writeonly uniform image2D radiance;
layout(r32f, binding = 6) writeonly uniform image2D view_depth;

#include "shaders/lib/objects.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/eye.glsl"

vec3 skyRadiance(vec3 w) { return mix(tick.sky_horizon, tick.sky_zenith, smoothstep(-0.15, 0.85, w.y)); }

// Nearest object along eye.position + depth * dir, in units of view depth; tick.opaque_count when there is none.
uint nearest(vec3 dir, out float depth, out vec3 normal) {
    uint hit = tick.opaque_count;
    depth = kMiss;
    normal = vec3(0, 1, 0);
    for (uint i = 0; i < tick.opaque_count; ++i) {
        vec3 n;
        const float t = hitObject(objects[i], eye.position, dir, n);
        if (t >= eye.near_depth && t < depth) {
            depth = t;
            normal = n;
            hit = i;
        }
    }
    return hit;
}

// Lambert's law under the light, past objects and medium, and under the sky, whose mean radiance stands for its irradiance.
vec3 surface(uint object, vec3 x, vec3 n) {
    const vec3 albedo = objects[object].albedo;
    const float cosine = dot(n, tick.to_light);
    vec3 light = mix(tick.sky_horizon, 0.5 * (tick.sky_horizon + tick.sky_zenith), 0.5 + 0.5 * n.y) * (0.5 + 0.5 * n.y);
    if (cosine > 0) {
        const float texel = (tick.opaque_hi.x - tick.opaque_lo.x) / float(tick.opaque_size);
        const vec3 at = toLightSpace(x + n * 2 * texel);
        const float slope = texel * 2 * sqrt(max(1 - cosine * cosine, 0)) / max(cosine, 0.1);
        light += tick.irradiance * (cosine / 3.14159265) * visibilityFiltered(at, slope) * exp(-lightDepth(toShadowVolume(x)));
    }
    return albedo * light;
}

vec3 shade(vec2 pixel, out float depth, out uint object) {
    const vec3 dir = rayDirection(pixel);
    vec3 n;
    object = nearest(dir, depth, n);
    if (object == tick.opaque_count) return skyRadiance(normalize(dir));
    return surface(object, eye.position + depth * dir, n);
}

uint objectAt(vec2 pixel) {
    float depth;
    vec3 n;
    return nearest(rayDirection(pixel), depth, n);
}

void main() {
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, eye.size))) return;
    const vec2 centre = vec2(gl_GlobalInvocationID.xy) + 0.5;
    float depth;
    uint object;
    vec3 colour = shade(centre, depth, object);
    if (tick.opaque_count > 0) {
        const uint a = objectAt(centre + vec2(-0.375, -0.125)), b = objectAt(centre + vec2(0.125, -0.375));
        const uint c = objectAt(centre + vec2(0.375, 0.125)), d = objectAt(centre + vec2(-0.125, 0.375));
        if (a != object || b != object || c != object || d != object) {
            float unused;
            uint id;
            colour = 0.25 * (shade(centre + vec2(-0.375, -0.125), unused, id) + shade(centre + vec2(0.125, -0.375), unused, id) +
                             shade(centre + vec2(0.375, 0.125), unused, id) + shade(centre + vec2(-0.125, 0.375), unused, id));
        }
    }
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    imageStore(radiance, at, vec4(colour, 1));
    imageStore(view_depth, at, vec4(depth));
}
