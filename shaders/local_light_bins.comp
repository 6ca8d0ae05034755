#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Local light bins, per eye: which lights may reach what the pixels of a bin see. A lane is a bin.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) uniform EyeBlock { Eye eye; };
layout(scalar, binding = 2) readonly buffer Lights { LocalLight local_lights[]; };
layout(scalar, binding = 3) writeonly buffer Bits { uint light_bits[]; };

#include "shaders/lib/eye.glsl"

void main() {
    const uvec2 bins = (eye.size + kLightBin - 1) / kLightBin;
    const uint bin = gl_GlobalInvocationID.x;
    if (bin >= bins.x * bins.y) return;
    // The cone of the bin's rays. Pictures are flat, so that the corners are furthest from the middle.
    const vec2 first = vec2(bin % bins.x, bin / bins.x) * float(kLightBin);
    const vec3 middle = normalize(rayDirection(first + 0.5 * float(kLightBin)));
    float cosine = 1;
    for (uint i = 0; i < 4; ++i)
        cosine = min(cosine, dot(middle, normalize(rayDirection(first + vec2(i & 1, i >> 1) * float(kLightBin)))));
    const float sine = sqrt(max(1 - cosine * cosine, 0)) * 1.001 + 1e-4;
    const uint words = (tick.local_light_count + 31) / 32;
    for (uint word = 0; word < words; ++word) {
        uint bits = 0;
        for (uint i = 32 * word; i < min(32 * word + 32, tick.local_light_count); ++i) {
            const LocalLight light = local_lights[i];
            const vec3 to = light.bound - eye.position;
            const float along = dot(to, middle), across = sqrt(max(dot(to, to) - along * along, 0));
            const bool near = dot(to, to) <= light.reach * light.reach;
            if (near || (along > -light.reach && across * cosine - along * sine <= light.reach)) bits |= 1u << (i & 31);
        }
        light_bits[bin * words + word] = bits;
    }
}
