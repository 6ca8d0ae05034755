#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Interpolates the medium, which was drawn at every kStep-th pixel (node), to the pixels between, per eye. Cells that
// an object's edge or shadow crosses are left out. A lane is a cell of kStep x kStep pixels; the lanes of a workgroup
// load their nodes together.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"

layout(local_size_x = 8, local_size_y = 8) in;
const uint kNodes = 8 + 3; // nodes along a side of a workgroup

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
layout(rgba32f) uniform image2D radiance;
// view_depth: set to 0 where the pixel is finished, so that the later draw skips it.
layout(r32f) uniform image2D view_depth;
// node_medium: one pixel per node; the first node is a step up and left of the picture.
uniform sampler2D node_medium;
uniform sampler2D node_depth;

layout(push_constant, scalar) uniform Push {
    float near, far;    // m, view depths of the medium
    float same;         // m, largest error of a cubic that is accepted
} push;

layout(constant_id = kIdStep) const uint kStep = 4;

#include "shaders/lib/cubic.glsl"
#include "shaders/lib/eye.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/caster_shadow.glsl"

shared vec4 medium[kNodes * kNodes];
shared vec2 lengths[kNodes * kNodes];

// The two depths (m) that make the medium on a ray change sharply: how much of it is in front of the opaque surface,
// and how much of that is in shadow. Where a cubic interpolates both well, it interpolates the medium well: its error
// is proportional.
vec2 sharpLengths(vec2 pixel, float depth) {
    const float end = clamp(depth, push.near, push.far);
    const vec3 dir = rayDirection(pixel);
    float shadow = 0;
    for (uint i = tick.plane_count; i < tick.opaque_count; ++i) {
        const vec2 range = shadowOf(objects[i], eye.position, dir);
        shadow += max(min(range.y, end) - max(range.x, push.near), 0);
    }
    return vec2(end, shadow);
}

void main() {
    const uvec2 corner = gl_WorkGroupID.xy * 8, cell = gl_GlobalInvocationID.xy;
    for (uint i = gl_LocalInvocationIndex; i < kNodes * kNodes; i += 64) {
        const ivec2 node = min(ivec2(corner + uvec2(i % kNodes, i / kNodes)), textureSize(node_depth, 0) - 1);
        medium[i] = texelFetch(node_medium, node, 0);
        lengths[i] = sharpLengths(vec2((node - 1) * int(kStep)) + 0.5, texelFetch(node_depth, node, 0).r);
    }
    barrier();
    const uint first = gl_LocalInvocationID.y * kNodes + gl_LocalInvocationID.x;
    for (uint y = 0; y < kStep; ++y) {
        vec4 column[4]; // the four columns of nodes at this row of pixels
        vec2 column_lengths[4];
        const vec4 down = cubic(float(y) / float(kStep));
        [[unroll]] for (uint i = 0; i < 4; ++i) {
            column[i] = vec4(0);
            column_lengths[i] = vec2(0);
            [[unroll]] for (uint j = 0; j < 4; ++j) {
                column[i] += down[j] * medium[first + j * kNodes + i];
                column_lengths[i] += down[j] * lengths[first + j * kNodes + i];
            }
        }
        for (uint x = 0; x < kStep; ++x) {
            const ivec2 at = ivec2(cell * kStep + uvec2(x, y));
            if (any(greaterThanEqual(at, ivec2(eye.size)))) break;
            const vec4 across = cubic(float(x) / float(kStep));
            vec2 off = -sharpLengths(vec2(at) + 0.5, imageLoad(view_depth, at).r);
            vec4 here = vec4(0);
            [[unroll]] for (uint i = 0; i < 4; ++i) {
                off += across[i] * column_lengths[i];
                here += across[i] * column[i];
            }
            if (abs(off.x) + abs(off.y) > push.same) continue;
            imageStore(radiance, at, vec4(max(here.rgb, 0), 0) + clamp(here.a, 0, 1) * imageLoad(radiance, at));
            imageStore(view_depth, at, vec4(0));
        }
    }
}
