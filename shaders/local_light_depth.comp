#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Local light depth, once a tick: the optical depth of the particles from a point or a spot to some distances in many
// directions (LocalLight::volume). A lane is a direction. A workgroup has 8x8 neighbouring ones, and tests each
// particle once for all of them.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/transmittance.h"
#include "shaders/shared/support.h"

layout(local_size_x = 8, local_size_y = 8) in;

#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer LightDepths { float light_depths[]; }; // of each volume [y][x][shell]

#include "shaders/lib/light_directions.glsl"

const uint kLanes = 64;
const float kEnd = 3.5; // of a Gaussian, in units of 1 / k: 4e-7 of its depth lie beyond

shared uint near_bits[2]; // particles of this round that some direction of the workgroup meets

void main() {
    const LocalLight light = local_lights[gl_WorkGroupID.z];
    if (light.volume == kNoVolume || any(greaterThanEqual(8 * gl_WorkGroupID.xy, uvec2(light.volume_side)))) return;
    const uint lane = gl_LocalInvocationIndex;
    const uvec2 node = gl_GlobalInvocationID.xy;
    const float to_square = 2 / float(light.volume_side - 1);
    const vec3 w = fromLightSquare(light, vec2(node) * to_square - 1);
    // The cone of the workgroup's directions. They do not cross the octahedron's edges where it is folded.
    const vec2 first = vec2(gl_WorkGroupID.xy * 8) * to_square - 1;
    const vec3 middle = fromLightSquare(light, first + 3.5 * to_square);
    float cosine = 1;
    for (uint i = 0; i < 4; ++i)
        cosine = min(cosine, dot(middle, fromLightSquare(light, first + 7 * to_square * vec2(i & 1, i >> 1))));
    cosine = cosine * 0.999 - 1e-3;
    const float sine = sqrt(1 - cosine * cosine);

    float added[kMostLightShells]; // between each distance and the one before it
    for (uint s = 0; s < light.volume_shells; ++s) added[s] = 0;
    for (uint round = 0; round < tick.particle_count; round += kLanes) {
        barrier();
        if (lane < 2) near_bits[lane] = 0;
        barrier();
        if (round + lane < tick.particle_count) {
            const Particle p = particles[round + lane];
            const vec3 to = p.centre - light.position;
            const float radius = supportRadius(p.sigma_t, p.scale * tick.falloff, tick.cut);
            const float along = dot(to, middle), across = sqrt(max(dot(to, to) - along * along, 0));
            const bool around = dot(to, to) <= radius * radius;
            if (around || (along > -radius && across * cosine - along * sine <= radius))
                atomicOr(near_bits[lane / 32], 1u << (lane & 31));
        }
        barrier();
        for (uint word = 0; word < 2; ++word)
            for (uint bits = near_bits[word]; bits != 0; bits &= bits - 1) {
                const Particle p = particles[round + 32 * word + findLSB(bits)];
                const vec3 to = p.centre - light.position;
                const float middle_at = dot(to, w), k = gaussianK(p.scale, tick.falloff);
                const vec3 off = to - middle_at * w;
                const float half_line = 0.5 * lineDepth(p.sigma_t, k, gaussianAcross(k, dot(off, off)));
                if (half_line < 0.1 * tick.cut || middle_at * k < -kEnd) continue;
                // The first distance stands for the light itself: nothing lies between.
                const vec2 ends = (middle_at + vec2(-kEnd, kEnd) / k - light.volume_near) / light.volume_step;
                const uint last = uint(clamp(ceil(ends.y), 0, float(light.volume_shells - 1)));
                uint s = uint(clamp(floor(ends.x), 0, float(light.volume_shells - 1)));
                float before = erf(k * (light.volume_near + float(s) * light.volume_step - middle_at));
                for (++s; s <= last; ++s) {
                    const float here = erf(k * (light.volume_near + float(s) * light.volume_step - middle_at));
                    added[s] += half_line * (here - before);
                    before = here;
                }
            }
    }
    const uint at = light.volume + (node.y * light.volume_side + node.x) * light.volume_shells;
    float sum = 0;
    for (uint s = 0; s < light.volume_shells; ++s) {
        sum += added[s];
        light_depths[at + s] = sum;
    }
}
