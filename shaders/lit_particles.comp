#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Light on particles for viewers who draw by themselves, once a tick and hue for all of them: a fit to the part of the
// sun's light that arrives in a particle (shared/lit_particles.h), and the light there that scattered more than once. A
// lane is a particle. The fit takes the centre, six points along the axes and twelve along the diagonals between two.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/particle_fit.h"
#include "shaders/shared/transmittance.h"

layout(local_size_x = 64) in;

layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdScattering) const uint kScatteringModel = 0;

#include "shaders/blocks/fluence.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer ParticleFits { ParticleFit fits[]; };

#include "shaders/lib/light.glsl"
#include "shaders/lib/fluence_at.glsl"

// The part of the sun's light that arrives at a point: through particles and past objects.
float arriving(vec3 x) {
    float light = exp(-lightDepthAnywhere(toShadowVolume(x)));
    if (kHasCasters) light *= visibility(toLightSpace(x));
    return light;
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= tick.particle_count) return;
    const Particle p = particles[i];
    const float reach = kFitReach / gaussianK(p.scale, tick.falloff), diagonal = 0.7071067811865476 * reach;
    ParticleFit fit;
    fit.middle = arriving(p.centre);
    for (int j = 0; j < 3; ++j) {
        vec3 a = vec3(0), b = vec3(0);
        a[j] = reach;
        const float above = arriving(p.centre + a), below = arriving(p.centre - a);
        fit.slope[j] = (above - below) / (2 * kFitReach);
        fit.bend[j] = (0.5 * (above + below) - fit.middle) / (kFitReach * kFitReach);
        // Mixed differences in the plane of the two other axes.
        a = b = vec3(0);
        a[(j + 1) % 3] = b[(j + 1) % 3] = a[(j + 2) % 3] = diagonal;
        b[(j + 2) % 3] = -diagonal;
        const float mixed =
            arriving(p.centre + a) + arriving(p.centre - a) - arriving(p.centre + b) - arriving(p.centre - b);
        fit.twist[j] = mixed / (4 * kFitReach * kFitReach);
    }
    const vec3 place = toShadowVolume(p.centre);
    for (uint c = 0; c < 3; ++c) {
        fit.fluence[c] = vec4(0);
        if (kScatteringModel != kScatteringPropagation || c >= tick.multiple.channels) continue;
        const vec4 there = fluenceAt(c, place); // net flux along the map's axes and down, fluence
        fit.fluence[c] = vec4(there.x * tick.map.x + there.y * tick.map.y - there.z * tick.sun.to_light, there.w);
    }
    fits[i] = fit;
}
