#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Light of the sun behind the union of balls, one value for each particle (Mattsson 2022): at its centre, past objects.
#include "shaders/shared/types.h"
#include "shaders/shared/splat.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer ParticleLights { ParticleLight lights[]; };
layout(scalar) readonly buffer UnionBits { uint union_bits[]; };

layout(push_constant, scalar) uniform Push {
    uint group, groups; // particles group, group + groups, group + 2 groups ... are written
} push;

#include "shaders/lib/objects.glsl"
#include "shaders/lib/object_tree.glsl"
#include "shaders/lib/behind_bodies.glsl"
#include "shaders/lib/union_ray.glsl"

const float kFarAway = 1e6; // m, where the sun's rays are taken to begin

void main() {
    const uint i = push.group + push.groups * gl_GlobalInvocationID.x;
    if (i >= tick.particle_count) return;
    const Particle p = particles[i];
    const UnionRay ray = unionRay(p.centre);
    const bool black = tick.balls.cutoff > 0 && ray.hits >= tick.balls.cutoff;
    const float through = exp(-tick.extinction * tick.balls.sigma_t * ray.path);
    const bool dark = black || isBehindBody(p.centre, kFarAway * tick.sun.to_light, true);
    lights[i] = ParticleLight(vec3(0), dark ? 0 : through, 0);
}
