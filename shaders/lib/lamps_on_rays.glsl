// Light of points and spots that particles in a slab of a ray scatter toward the eye, of those that isOnRays() tells.
// Include after lib/eye.glsl, lib/field_planes.glsl, lib/slab_depth.glsl and lib/medium_phase.glsl.
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require
#include "shaders/blocks/light_bits.glsl"
#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/is_on_rays.glsl"
#include "shaders/lib/lamp.glsl"
#include "shaders/lib/local_light_depth.glsl"
#include "shaders/shared/equiangular.h"
#include "shaders/shared/scatter.h"

const float kThinSlab = 0.1; // optical depth up to which the depth toward a light is that of the slab's middle

// What the slab scatters of one light of intensity 1. `unit`: the ray's direction; begin, end: m from the eye; depth:
// of the slab; slope: by how much its extinction grows from begin to end, as a part of the mean.
float ofLamp(LocalLight light, vec3 unit, float begin, float end, float depth, float slope) {
    const float closest = dot(light.position - eye.position, unit), length_of_slab = end - begin;
    const vec3 offset = eye.position + closest * unit - light.position; // from the light to the ray's closest place
    const float square = dot(offset, offset) + light.radius * light.radius;
    const EquiangularPart part = equiangularPart(sqrt(square), begin - closest, end - closest);
    float lit, grows = slope - depth; // by how much what scatters grows from begin to end, as a part of the mean
    if (depth < kThinSlab) {
        const vec3 middle = offset + (0.5 * (begin + end) - closest) * unit;
        lit = opacity(depth) * exp(-particlesFrom(light, middle, length(middle)));
    } else {
        const vec3 from = offset + (begin - closest) * unit, to = offset + (end - closest) * unit;
        const float light_in = particlesFrom(light, from, length(from));
        const float light_out = particlesFrom(light, to, length(to));
        lit = scatterAnalytic(depth, light_in, light_out);
        grows -= light_out - light_in;
    }
    // Cone, range and phase are looked up where half of the light comes from, moved to the middle of what scatters. The
    // inverse square is even in the angle.
    const float even = equiangularPlace(part, 0.5), t = even + clamp(grows, -2, 2) / 12 * length_of_slab;
    const vec3 away = offset + t * unit;
    const float distance = length(away), sent = sentTo(light, away, distance);
    const float falls = equiangularWeight(part) / length_of_slab * (even * even + square) / (t * t + square);
    return sent * falls * lit * mediumPhase(away / max(distance, 1e-20), -unit);
}

LocalLight ofLane(LocalLight own, uint j) {
    LocalLight light;
    light.position = vec3(subgroupShuffle(own.position.x, j), subgroupShuffle(own.position.y, j),
                          subgroupShuffle(own.position.z, j));
    light.range = subgroupShuffle(own.range, j);
    light.intensity = vec3(subgroupShuffle(own.intensity.x, j), subgroupShuffle(own.intensity.y, j),
                           subgroupShuffle(own.intensity.z, j));
    light.radius = subgroupShuffle(own.radius, j);
    light.axis =
        vec3(subgroupShuffle(own.axis.x, j), subgroupShuffle(own.axis.y, j), subgroupShuffle(own.axis.z, j));
    light.cos_outer = subgroupShuffle(own.cos_outer, j);
    light.cone_width = subgroupShuffle(own.cone_width, j);
    light.volume = subgroupShuffle(own.volume, j);
    light.volume_side = subgroupShuffle(own.volume_side, j);
    light.volume_shells = subgroupShuffle(own.volume_shells, j);
    light.volume_near = subgroupShuffle(own.volume_near, j);
    light.volume_step = subgroupShuffle(own.volume_step, j);
    light.volume_axis = vec3(subgroupShuffle(own.volume_axis.x, j), subgroupShuffle(own.volume_axis.y, j),
                             subgroupShuffle(own.volume_axis.z, j));
    light.volume_cosine = subgroupShuffle(own.volume_cosine, j);
    return light;
}

// Of all of them, without albedo, before anything dims it toward the eye. `bin`: of LightBits; near, far: view depths;
// `ray`: of unit view depth, `metres` long. Called by all lanes: each loads one light, for all.
vec3 lampsOfSlab(uint bin, vec3 ray, float metres, float near, float far, float depth, float slope) {
    vec3 sum = vec3(0);
    const uint lanes = min(gl_SubgroupSize, 32);
    for (uint word = 0; word < lightWords(); ++word) {
        const uint any = subgroupOr(light_bits[bin + word]);
        for (uint first = 0; first < 32; first += lanes) {
            uint bits = any >> first & (0xffffffffu >> (32 - lanes));
            if (bits == 0) continue;
            LocalLight own;
            bool on_rays = false;
            if (gl_SubgroupInvocationID < lanes && (bits >> gl_SubgroupInvocationID & 1) != 0) {
                own = local_lights[32 * word + first + gl_SubgroupInvocationID];
                on_rays = isOnRays(own);
            }
            bits &= subgroupBallot(on_rays).x;
            while (bits != 0) {
                const LocalLight light = ofLane(own, findLSB(bits));
                bits &= bits - 1;
                sum += light.intensity * ofLamp(light, ray / metres, near * metres, far * metres, depth, slope);
            }
        }
    }
    return sum;
}
