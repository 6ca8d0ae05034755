#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Local light bins, per eye: which lights may reach what the pixels of a bin see. A lane is a bin.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer LightBits { uint light_bits[]; };

#include "shaders/lib/eye.glsl"

const float kEndless = 1e15; // m, a range
const float kNarrow = 0.7;   // cosine of a spot's outer angle, above which its cone is narrower than a ball
const uint kMostBalls = 12;  // of a spot

// True if a ball meets the cone about `middle`.
bool meets(vec3 centre, float radius, vec3 middle, float cosine, float sine) {
    const vec3 to = centre - eye.position;
    const float along = dot(to, middle), across = sqrt(max(dot(to, to) - along * along, 0));
    if (dot(to, to) <= radius * radius) return true;
    return along > -radius && across * cosine - along * sine <= radius;
}

// True if the light may reach a place in the cone. A spot's own cone is cut into balls that grow with their distance
// from its tip, and hold all between a distance and the next.
bool mayReach(LocalLight light, vec3 middle, float cosine, float sine) {
    if (!meets(light.bound, light.reach, middle, cosine, sine)) return false;
    if (light.cos_outer < kNarrow || light.range >= kEndless) return true;
    const float slope = sqrt(1 - light.cos_outer * light.cos_outer) / light.cos_outer, growth = 1 + 2 * slope;
    float far = light.range; // along the axis
    for (uint n = 0; n < kMostBalls; ++n) {
        const float near = n == kMostBalls - 1 ? 0 : far / growth, half_length = 0.5 * (far - near);
        const float radius = sqrt(half_length * half_length + slope * slope * far * far);
        if (meets(light.position + (near + half_length) * light.axis, radius, middle, cosine, sine)) return true;
        far = near;
    }
    return false;
}

void main() {
    const uvec2 bins = (eye.size + kPixelTile - 1) / kPixelTile;
    const uint bin = gl_GlobalInvocationID.x;
    if (bin >= bins.x * bins.y) return;
    // The cone of the bin's rays. Pictures are flat, so that the corners are furthest from the middle.
    const vec2 first = vec2(bin % bins.x, bin / bins.x) * float(kPixelTile);
    const vec3 middle = normalize(rayDirection(first + 0.5 * float(kPixelTile)));
    float cosine = 1;
    for (uint i = 0; i < 4; ++i)
        cosine = min(cosine, dot(middle, normalize(rayDirection(first + vec2(i & 1, i >> 1) * float(kPixelTile)))));
    const float sine = sqrt(max(1 - cosine * cosine, 0)) * 1.001 + 1e-4;
    const uint words = (tick.local_light_count + 31) / 32;
    for (uint word = 0; word < words; ++word) {
        uint bits = 0;
        for (uint i = 32 * word; i < min(32 * word + 32, tick.local_light_count); ++i)
            if (mayReach(local_lights[i], middle, cosine, sine)) bits |= 1u << (i & 31);
        light_bits[bin * words + word] = bits;
    }
}
