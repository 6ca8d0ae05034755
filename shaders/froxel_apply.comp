#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Methods with froxels, last pass, per eye: the medium before each pixel's surface, over what is drawn there. A lane is
// a pixel. Optical depth is linear between four rays and two faces,
// light between rays. Behind the last face lies fog alone.
#include "shaders/shared/constants.h"
#include "shaders/shared/froxels.h"

layout(local_size_x = 16, local_size_y = 4) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(rgba32f) uniform image2D radiance;
layout(scalar) readonly buffer Volume { vec4 volume[]; }; // written by froxels.comp

layout(push_constant, scalar) uniform Push {
    FroxelGrid froxels;
    uvec2 rows; // of pixels: first, end
} push;

#include "shaders/lib/eye.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/froxel_depth.glsl"
#include "shaders/lib/fog_behind.glsl"

// Light and optical depth between rays at a face.
vec4 atFace(uint face, uvec2 ray, vec2 part) {
    const uint at = froxelAt(face, ray);
    const vec4 upper = mix(volume[at], volume[at + 1], part.x);
    const uint below = at + push.froxels.rays.x;
    return mix(upper, mix(volume[below], volume[below + 1], part.x), part.y);
}

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy + uvec2(0, push.rows.x);
    if (pixel.x >= eye.size.x || pixel.y >= push.rows.y) return;
    const float end = kHasOpaque ? texelFetch(view_depth, ivec2(pixel), 0).r : kEndless;
    const vec2 at = vec2(pixel) / float(push.froxels.pixels) - vec2(0, push.froxels.first_row);
    const uvec2 ray = uvec2(at);
    const float face = min(faceAt(end), float(push.froxels.slices));
    const uint below = min(uint(face), push.froxels.slices - 1);
    vec4 medium = vec4(0);
    if (face > 0) {
        const vec4 near = atFace(below, ray, at - vec2(ray)), far = atFace(below + 1, ray, at - vec2(ray));
        const float part = face - float(below);
        medium = mix(near, far, part);
        // Light grows with the opacity, not with the depth: a furnace has no colour.
        const float even = mix(opacity(near.a), opacity(far.a), part);
        if (even > 0) medium.rgb *= opacity(medium.a) / even;
    }
    const float last = faceDepth(float(push.froxels.slices));
    if (kHasFog && end > last && medium.a < 30) {
        const vec3 dir = rayDirection(vec2(pixel) + 0.5);
        medium.rgb += fogBehind(dir, last, end, medium.a);
    }
    if (medium == vec4(0)) return;
    imageStore(radiance, ivec2(pixel), vec4(medium.rgb, 0) + exp(-medium.a) * imageLoad(radiance, ivec2(pixel)));
}
