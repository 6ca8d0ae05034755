#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Sprites: light of a particle by six-way light maps, and its opacity. Premultiplied over what is behind it, so that
// the opacities of all sprites on a ray count; equation 4.1 of Mattsson (2022) keeps the last one alone.
#include "shaders/shared/types.h"
#include "shaders/shared/six_way.h"

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Maps {
    uint map_side, map_frames;
    vec4 map_texels[]; // [frame][row][column]: from the right, the top and the front, depth; from the other sides
};

layout(location = 0) in vec2 at;
layout(location = 1) flat in vec4 albedo_light;
layout(location = 2) flat in vec3 depth_radius;
layout(location = 3) flat in uint particle;

layout(location = 0) out vec4 radiance_transmittance;

#include "shaders/lib/medium_shading.glsl"

// The texels around a place, between which it is linear.
void readMaps(vec2 place, out vec4 positive, out vec4 negative) {
    const vec2 texel = clamp(place * float(map_side) - 0.5, vec2(0), vec2(map_side - 1));
    const uvec2 lo = uvec2(texel), hi = min(lo + 1, uvec2(map_side - 1));
    const vec2 part = texel - vec2(lo);
    const uint first = particle % map_frames * map_side * map_side;
    const uint above = first + lo.y * map_side, below = first + hi.y * map_side;
    const uvec4 texels = 2 * uvec4(above + lo.x, above + hi.x, below + lo.x, below + hi.x);
    positive = mix(mix(map_texels[texels.x], map_texels[texels.y], part.x),
                   mix(map_texels[texels.z], map_texels[texels.w], part.x), part.y);
    negative = mix(mix(map_texels[texels.x + 1], map_texels[texels.y + 1], part.x),
                   mix(map_texels[texels.z + 1], map_texels[texels.w + 1], part.x), part.y);
}

void drawSprite() {
    vec4 positive, negative;
    readMaps(vec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y), positive, negative);
    float depth = depth_radius.z * positive.w;
    if (kHasOpaque) { // the part of the ball before a surface
        const float surface = texelFetch(view_depth, ivec2(gl_FragCoord.xy), 0).r;
        depth *= clamp(0.5 + (surface - depth_radius.x) / (2 * depth_radius.y), 0, 1);
    }
    if (!(depth > 0)) discard;
    const vec3 toward =
        vec3(dot(eye.right, tick.sun.to_light), dot(eye.up, tick.sun.to_light), dot(eye.back, tick.sun.to_light));
    const float light = albedo_light.a * sixWayLight(toward, positive.rgb, negative.rgb);
    const RayParticle ray = rayParticle(vec3(0));
    radiance_transmittance = composed(ray, albedo_light.rgb, light * opacity(depth), depth);
}

void main() {
    if (isFinished()) discard;
    else drawSprite(); // CPU drivers skip this branch, but not code after a discard
}
