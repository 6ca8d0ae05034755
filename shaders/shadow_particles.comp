#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Volumetric shadow map, first pass: per particle its place in light space, and per slice plane the part of its column depth
// that lies between the plane and the light. The light is parallel, so this is one erfc per particle and plane, not per texel:
// tau_L(x) = [sigma sqrt(pi)/(2k) erfc(k s)] exp(-k^2 b^2), s = height of x above the centre along to_light (physics: light depth).
#include "shaders/shared/types.h"
#include "shaders/shared/transmittance.h"
#include "shaders/shared/support.h"

layout(local_size_x = 64) in;

const uint kPlanes = 16; // of one group of planes

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 2) readonly buffer Particles { Particle particles[]; };
layout(scalar, binding = 3) writeonly buffer LightParticles { LightParticle light_particles[]; };
layout(scalar, binding = 4) writeonly buffer Columns { float columns[]; }; // [particle][kPlanes]

layout(push_constant, scalar) uniform Push { uint first_plane; } push;

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= tick.particle_count) return;
    const Particle p = particles[i];
    const float u = p.scale * tick.falloff;
    const float k = gaussianK(p.scale, tick.falloff);
    light_particles[i] = LightParticle(vec2(dot(tick.light_x, p.centre), dot(tick.light_y, p.centre)), k, supportRadius(p.sigma_t, u, tick.cut));
    const float spacing = (tick.shadow_hi.z - tick.shadow_lo.z) / float(tick.shadow_slices - 1);
    const float height = dot(tick.to_light, p.centre);
    for (uint j = 0; j < kPlanes; ++j) {
        const float plane = tick.shadow_hi.z - float(push.first_plane + j) * spacing;
        columns[i * kPlanes + j] = lightDepth(p.sigma_t, k, 1.0, k * (plane - height));
    }
}
