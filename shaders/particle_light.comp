#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Light cached on particles, once per tick: a fit T_L = T + G . r + C k^2 r^2 to the light's transmittance, r from
// the centre. It uses the centre and six points at sqrt(3) standard deviations around it; mean and first moments over
// the particle's Gaussian are kept. kLookUp is written where the fit is not enough, and methods then look the light
// up at every point. That is the case if
// - the points differ from the fit by more than a tolerance (after seed 001's test: samples against interpolation),
// - the particle shadows itself, or
// - the edge of an opaque shadow may cross the particle.
#include "shaders/shared/types.h"
#include "shaders/shared/splat.h"
#include "shaders/shared/support.h"
#include "shaders/shared/transmittance.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/axes.glsl"
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer ParticleLights { ParticleLight lights[]; };

layout(push_constant, scalar) uniform Push {
    float tolerance; // of T_L, 0 ... 1
} push;

#include "shaders/lib/light.glsl"

// Optical depth of a particle above which its own shadow does not fit the polynomial. The error there is 5 % of the
// scattered light.
const float kOwnShadow = 0.55;

const int kLit = 0, kDark = 1, kPartly = 2;

// An object seen from the light. Returns the distance of `at` (light space, relative to the centre) from its outline,
// and how far the object reaches up and down. The distance is negative inside, and never larger than the true one
// outside. A box's outline is the intersection of three strips.
void outline(Opaque o, vec2 at, out float outside, out float height) {
    outside = length(at) - o.half_size.x;
    height = o.half_size.x;
    if (o.kind == kSphere) return;
    const vec3 edge[3] =
        vec3[](toLightSpace(o.half_size.x * vec3(o.yaw_cos, 0, -o.yaw_sin)), toLightSpace(vec3(0, o.half_size.y, 0)),
               toLightSpace(o.half_size.z * vec3(o.yaw_sin, 0, o.yaw_cos)));
    outside = -1e30;
    height = 0;
    for (int i = 0; i < 3; ++i) {
        height += abs(edge[i].z);
        const vec2 along = edge[i].xy, across = vec2(-along.y, along.x);
        const float reach = abs(dot(across, edge[(i + 1) % 3].xy)) + abs(dot(across, edge[(i + 2) % 3].xy));
        if (dot(along, along) > 1e-12)
            outside = max(outside, (abs(dot(across, at)) - reach) * inversesqrt(dot(along, along)));
    }
}

// The part of the light that opaque objects let through, within `radius` (m) of a point in light space.
int shade(vec3 at, float radius) {
    int result = kLit;
    for (uint i = 0; i < tick.opaque_count; ++i) {
        const Opaque o = objects[i];
        if (o.kind == kPlane) continue; // there is nothing below a plane
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
    // Texels of the opaque shadow map, which methods look up, too (m).
    const vec2 texel = (tick.map.opaque_hi - tick.map.opaque_lo) / float(tick.map.opaque_size);
    const int shadow = shade(toLightSpace(p.centre), max(supportRadius(p.sigma_t, u, tick.cut), 0) + length(texel));

    const float reach = 0.173205081 * u; // k reach = sqrt(3/2)
    const float centre = exp(-lightDepth(toShadowVolume(p.centre)));
    vec3 gradient = vec3(0), bend; // bend: mean of two opposite points minus the centre
    mat3 own = mat3(1); // semi-axes
    if (kEllipsoids) own = mat3(axes[i].a, axes[i].b, axes[i].c);
    for (int j = 0; j < 3; ++j) {
        const vec3 step = reach * own[j];
        const float above = exp(-lightDepth(toShadowVolume(p.centre + step)));
        const float below = exp(-lightDepth(toShadowVolume(p.centre - step)));
        if (kEllipsoids) gradient += (above - below) / (2 * dot(step, step)) * step;
        else gradient[j] = (above - below) / (2 * reach);
        bend[j] = 0.5 * (above + below) - centre;
    }
    const float mean_bend = (bend.x + bend.y + bend.z) / 3;
    const vec3 apart = abs(bend - mean_bend);
    const bool look_up = shadow == kPartly || max(max(apart.x, apart.y), apart.z) > push.tolerance ||
                         lineDepth(p.sigma_t, gaussianK(p.scale, tick.falloff), 1) > kOwnShadow;
    if (shadow == kDark) lights[i] = ParticleLight(vec3(0), 0, 0);
    else lights[i] = ParticleLight(gradient, look_up ? kLookUp : centre, mean_bend / 1.5);
}
