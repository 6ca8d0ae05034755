#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `march`, last pass, per eye: the medium before each pixel's surface, over what is drawn there. A lane is a
// pixel. Between marched pixels it takes those around whose surfaces lie where its own does.
#include "shaders/shared/constants.h"
#include "shaders/shared/march.h"

layout(local_size_x = 16, local_size_y = 4) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(rgba32f) uniform image2D radiance;
layout(scalar) readonly buffer Seen { vec4 seen[]; };   // [row][column]: light, opacity
layout(scalar) readonly buffer Ends { float ends[]; };  // [row][column]: m of view depth

layout(push_constant, scalar) uniform Push {
    MarchBand band;
    uvec2 rows; // of pixels: first, end
} push;

#include "shaders/lib/eye.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/depth_weight.glsl"

float surfaceAt(ivec2 pixel) {
    if (!kHasOpaque) return push.band.far;
    return min(texelFetch(view_depth, clamp(pixel, ivec2(0), ivec2(eye.size) - 1), 0).r, push.band.far);
}

// Light and opacity at a pixel, from four marched ones around it. Where none of them has its depth, the one whose
// depth is nearest.
vec4 between(uvec2 pixel, float own) {
    const float rate = float(push.band.rate);
    const vec2 at = (vec2(pixel) - float(push.band.rate / 2)) / rate - vec2(0, push.band.first_row);
    const ivec2 first = ivec2(floor(at)), last = ivec2(push.band.size) - 1;
    const vec2 part = at - vec2(first);
    const ivec2 here = ivec2(pixel);
    const vec2 slope = vec2(slopeOf(surfaceAt(here - ivec2(1, 0)), own, surfaceAt(here + ivec2(1, 0))),
                            slopeOf(surfaceAt(here - ivec2(0, 1)), own, surfaceAt(here + ivec2(0, 1))));
    vec4 sum = vec4(0), nearest = vec4(0);
    float weights = 0, least = kEndless;
    [[unroll]] for (int c = 0; c < 4; ++c) {
        const ivec2 side = ivec2(c & 1, c >> 1), node = clamp(first + side, ivec2(0), last);
        const vec2 share = mix(1 - part, part, vec2(side));
        const uint index = uint(node.y) * push.band.size.x + uint(node.x);
        const vec2 middle = rate * (vec2(node) + vec2(0, push.band.first_row)) + float(push.band.rate / 2);
        const vec2 marched = min(middle, vec2(eye.size) - 1);
        const float off = ends[index] - own - dot(slope, marched - vec2(pixel));
        const float weight = share.x * share.y * depthWeight(off);
        sum += weight * seen[index];
        weights += weight;
        if (abs(off) < least) {
            least = abs(off);
            nearest = seen[index];
        }
    }
    return weights > 1e-3 ? sum / weights : nearest;
}

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy + uvec2(0, push.rows.x);
    if (pixel.x >= eye.size.x || pixel.y >= push.rows.y) return;
    const uint index = (pixel.y - push.band.first_row) * push.band.size.x + pixel.x;
    vec4 medium = push.band.rate == 1 ? seen[index] : between(pixel, surfaceAt(ivec2(pixel)));
    float transmittance = 1 - medium.a;
    if (push.band.particles == 0) { // fog has a closed form, which is the pixel's own
        const vec3 dir = rayDirection(vec2(pixel) + 0.5);
        const float end = kHasOpaque ? texelFetch(view_depth, ivec2(pixel), 0).r : kEndless;
        const float own = fogBetween(eye.position, dir, length(dir), push.band.near, end);
        if (medium.a > 0) medium.rgb *= opacity(own) / medium.a;
        transmittance = exp(-own);
    }
    if (transmittance == 1 && medium.rgb == vec3(0)) return;
    imageStore(radiance, ivec2(pixel), vec4(medium.rgb, 0) + transmittance * imageLoad(radiance, ivec2(pixel)));
}
