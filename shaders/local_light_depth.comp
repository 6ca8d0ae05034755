#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
// Local light depth, once a tick: the optical depth of the particles from a point or a spot to some distances in many
// directions (LocalLight::volume). A lane is a direction. A workgroup has 8x8 neighbouring ones. The lanes of a
// subgroup load and test a particle each, and then add those that some of its directions meets.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/transmittance.h"
#include "shaders/shared/support.h"

layout(local_size_x = 8, local_size_y = 8) in;

#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/axes.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer LightDepths { float light_depths[]; }; // of each volume [y][x][shell]

#include "shaders/lib/light_directions.glsl"
#include "shaders/lib/spread.glsl"

const float kEnd = 3.5; // of a Gaussian, in units of 1 / k: 4e-7 of its depth lie beyond
// Between two distances, in the same units: up to that the Gaussian is summed by steps (erfSteps()). They err by a
// thirtieth of what looking up between the distances does.
const float kMostStep = 1;

vec3 ofLane(vec3 v, uint lane) {
    return vec3(subgroupShuffle(v.x, lane), subgroupShuffle(v.y, lane), subgroupShuffle(v.z, lane));
}

void main() {
    const uvec3 group = spreadGroup();
    const LocalLight light = local_lights[group.z];
    if (light.volume == kNoVolume || any(greaterThanEqual(8 * group.xy, uvec2(light.volume_side)))) return;
    const uint lane = gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID;
    // Neighbouring lanes have directions that are neighbours both ways: blocks of 4x2, of 4x4, of 8x4.
    const uvec2 node = 8 * group.xy + uvec2(lane & 3 | lane >> 1 & 4, lane >> 2 & 1 | lane >> 3 & 6);
    const float to_square = 2 / float(light.volume_side - 1);
    const vec3 w = fromLightSquare(light, vec2(node) * to_square - 1);
    // The cone of the subgroup's directions.
    const vec3 middle = normalize(subgroupAdd(w));
    float cosine = subgroupMin(dot(middle, w));
    cosine = cosine * 0.999 - 1e-3;
    const float sine = sqrt(1 - cosine * cosine);

    float added[kMostLightShells]; // between each distance and the one before it
    for (uint s = 0; s < light.volume_shells; ++s) added[s] = 0;
    const uint lanes = min(gl_SubgroupSize, 32);
    for (uint round = 0; round < tick.particle_count; round += lanes) {
        bool met = false;
        vec3 own_to = vec3(0);
        float own_k = 1, own_line = 0;
        EllipsoidAxes own_axes = EllipsoidAxes(vec3(0), vec3(0), vec3(0));
        if (gl_SubgroupInvocationID < lanes && round + gl_SubgroupInvocationID < tick.particle_count) {
            const Particle p = particles[round + gl_SubgroupInvocationID];
            own_to = p.centre - light.position;
            own_k = gaussianK(p.scale, tick.falloff);
            own_line = p.sigma_t;
            if (kEllipsoids) own_axes = axes[round + gl_SubgroupInvocationID];
            const float radius = supportRadius(p.sigma_t, p.scale * tick.falloff, tick.cut);
            const float along = dot(own_to, middle), across = sqrt(max(dot(own_to, own_to) - along * along, 0));
            const bool around = dot(own_to, own_to) <= radius * radius;
            met = around || (along > -radius && across * cosine - along * sine <= radius);
        }
        uint bits = subgroupBallot(met).x;
        if (bits != 0) do { // the loop's condition is at its end: see lib/tile_members.glsl
                const uint j = findLSB(bits);
                bits &= bits - 1;
                const vec3 to = vec3(subgroupShuffle(own_to.x, j), subgroupShuffle(own_to.y, j),
                                     subgroupShuffle(own_to.z, j));
                float k = subgroupShuffle(own_k, j);
                const float sigma_t = subgroupShuffle(own_line, j);
                float middle_at = dot(to, w);
                const vec3 off = to - middle_at * w;
                float b2 = dot(off, off);
                if (kEllipsoids) {
                    const BallOnLine ball =
                        ballOnLine(to, w, k, ofLane(own_axes.a, j), ofLane(own_axes.b, j), ofLane(own_axes.c, j));
                    k = ball.k, middle_at = ball.closest, b2 = ball.b2;
                }
                const float half_line = 0.5 * lineDepth(sigma_t, k, gaussianAcross(k, b2));
                if (half_line >= 0.1 * tick.cut && middle_at * k >= -kEnd) {
                    // The first distance stands for the light itself: nothing lies between.
                    const vec2 ends = (middle_at + vec2(-kEnd, kEnd) / k - light.volume_near) / light.volume_step;
                    const uint last = uint(clamp(ceil(ends.y), 0, float(light.volume_shells - 1)));
                    uint s = uint(clamp(floor(ends.x), 0, float(light.volume_shells - 1)));
                    const float step = k * light.volume_step;
                    const float start = k * (light.volume_near - middle_at);
                    if (s < last && step <= kMostStep) {
                        ErfSteps steps = erfSteps(start + (float(s) + 0.5) * step, step);
                        do {
                            added[++s] += half_line * steps.value;
                            steps.value *= steps.ratio;
                            steps.ratio *= steps.change;
                        } while (s < last);
                    } else if (s < last) {
                        float before = erf(start + float(s) * step);
                        do {
                            const float here = erf(start + float(s + 1) * step);
                            added[++s] += half_line * (here - before);
                            before = here;
                        } while (s < last);
                    }
                }
            } while (bits != 0);
    }
    const uint at = light.volume + (node.y * light.volume_side + node.x) * light.volume_shells;
    float sum = 0;
    for (uint s = 0; s < light.volume_shells; ++s) {
        sum += added[s];
        light_depths[at + s] = sum;
    }
}
