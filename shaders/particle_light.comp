#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Once per tick: the light that reaches every particle, T_L(x) = T + G . (x - centre), fitted by least squares with the particle's own
// Gaussian as the weight. Six points at sqrt(3) standard deviations along the axes do that exactly for a cubic T_L.
// Where a line is not enough, kLookUp is written and methods look the light up point by point: where the mean of two opposite points
// disagrees with the centre (after seed 001's test: what samples and interpolation differ by), where the particle shadows itself,
// and where the edge of an opaque shadow may cut it.
#include "shaders/shared/types.h"
#include "shaders/shared/splat.h"
#include "shaders/shared/support.h"
#include "shaders/shared/transmittance.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) readonly buffer Objects { Opaque objects[]; };
layout(scalar, binding = 2) readonly buffer Particles { Particle particles[]; };
layout(binding = 3) uniform sampler2DArray shadow_volume;
layout(binding = 4) uniform sampler2D opaque_shadow; // for light.glsl alone
layout(scalar, binding = 5) writeonly buffer Lights { ParticleLight lights[]; };

layout(push_constant, scalar) uniform Push {
    float tolerance; // of T_L
} push;

#include "shaders/lib/light.glsl"

// Optical depth of a particle whose lit side, which its far side does not show, is brighter than a line says: by 0.08 of 1 at most here.
const float kOwnShadow = 1.2;

const int kLit = 0, kDark = 1, kPartly = 2;

// Of an object seen from the light: how far `at`, in light space and relative to the centre, lies outside of its outline (negative
// inside, never more than the true distance outside), and how far it reaches up and down. A box's outline is where three strips meet.
void outline(Opaque o, vec2 at, out float outside, out float height) {
    outside = length(at) - o.half_size.x;
    height = o.half_size.x;
    if (o.kind == kSphere) return;
    const vec3 edge[3] = vec3[](toLightSpace(o.half_size.x * vec3(o.yaw_cos, 0, -o.yaw_sin)), toLightSpace(vec3(0, o.half_size.y, 0)),
                                toLightSpace(o.half_size.z * vec3(o.yaw_sin, 0, o.yaw_cos)));
    outside = -1e30;
    height = 0;
    for (int i = 0; i < 3; ++i) {
        height += abs(edge[i].z);
        const vec2 along = edge[i].xy, across = vec2(-along.y, along.x);
        const float reach = abs(dot(across, edge[(i + 1) % 3].xy)) + abs(dot(across, edge[(i + 2) % 3].xy));
        if (dot(along, along) > 1e-12) outside = max(outside, (abs(dot(across, at)) - reach) * inversesqrt(dot(along, along)));
    }
}

// What the opaque objects leave of the light within `radius` of a point in light space.
int shade(vec3 at, float radius) {
    int result = kLit;
    for (uint i = 0; i < tick.opaque_count; ++i) {
        const Opaque o = objects[i];
        if (o.kind == kPlane) continue; // nothing lies below it
        const vec3 from = at - toLightSpace(o.centre);
        float outside, height;
        outline(o, from.xy, outside, height);
        if (outside > radius || from.z > height + radius) continue;
        if (outside < -radius && from.z < -height - radius) return kDark;
        result = kPartly;
    }
    return result;
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= tick.particle_count) return;
    const Particle p = particles[i];
    const float u = p.scale * tick.falloff;
    const vec2 texel = (tick.opaque_hi - tick.opaque_lo) / float(tick.opaque_size); // as coarse is the map that points look up
    const int shadow = shade(toLightSpace(p.centre), max(supportRadius(p.sigma_t, u, tick.cut), 0) + length(texel));

    const float reach = 0.173205081 * u;
    const float centre = exp(-lightDepth(toShadowVolume(p.centre)));
    float mean = 0, deviation = 0;
    vec3 gradient = vec3(0);
    for (int j = 0; j < 3; ++j) {
        vec3 step = vec3(0);
        step[j] = reach;
        const float above = exp(-lightDepth(toShadowVolume(p.centre + step)));
        const float below = exp(-lightDepth(toShadowVolume(p.centre - step)));
        mean += (above + below) / 6;
        gradient[j] = (above - below) / (2 * reach);
        deviation = max(deviation, abs(0.5 * (above + below) - centre));
    }
    const bool look_up =
        shadow == kPartly || deviation > push.tolerance || lineDepth(p.sigma_t, gaussianK(p.scale, tick.falloff), 1) > kOwnShadow;
    if (shadow == kDark) lights[i] = ParticleLight(vec3(0), 0);
    else lights[i] = ParticleLight(gradient, look_up ? kLookUp : mean);
}
