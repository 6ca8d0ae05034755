#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Interval shading: the interval comes from two interpolated depths; light depth is linear between its ends (seed 000
// eq. 8).
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/orientation.h"

#include "shaders/blocks/axes.glsl"
#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/tick.glsl"

layout(location = 0) flat in vec4 centre_scale;
layout(location = 1) flat in vec4 albedo_sigma;
// Linear in the picture, since w is 1 at every vertex. (Mesa 25 clips noperspective inputs wrong.)
layout(location = 2) in vec2 inverse_depth;
layout(location = 3) flat in uint particle_clipped; // the lowest bit: IntervalProxy::clipped

layout(location = 0) out vec4 radiance_transmittance;

layout(constant_id = kIdQuadrature) const uint kQuadrature = 0;
layout(constant_id = kIdSteps) const int kSteps = 2;
layout(constant_id = kIdFading) const bool kFading = true;
layout(constant_id = kIdLegacyTerm) const bool kLegacyTerm = false;
layout(constant_id = kIdTurned) const bool kTurned = false;
layout(constant_id = kIdTaylorStep) const bool kTaylorStep = false;
layout(constant_id = kIdTaylorShadows) const bool kTaylorShadows = true;

layout(push_constant, scalar) uniform Push {
    float multiple;    // m of eq. 11
    float taylor_step; // m
} push;

#include "shaders/lib/medium_shading.glsl"
#include "shaders/lib/early_return.glsl"

// The part of the ray inside the tetrahedron, from its four face planes in particle-centred coordinates.
vec2 intervalFromPlanes(vec3 w, vec3 centre, float scale) {
    const vec3 normal[4] =
        vec3[](vec3(-0.57735026919), vec3(-0.57735026919, 0.57735026919, 0.57735026919),
               vec3(0.57735026919, -0.57735026919, 0.57735026919), vec3(0.57735026919, 0.57735026919, -0.57735026919));
    vec2 interval = vec2(-1e30, 1e30);
    for (int i = 0; i < 4; ++i) {
        const float away = dot(normal[i], w);
        const float t = (scale / 3 + dot(normal[i], centre)) / (abs(away) < 1e-12 ? 1e-12 : away);
        if (away < 0) interval.x = max(interval.x, t);
        else interval.y = min(interval.y, t);
    }
    return interval;
}

void drawParticle() {
    const vec3 centre = centre_scale.xyz;
    const float scale = centre_scale.w;
    RayParticle ray = rayParticle(centre);
    const float per_depth = ray.begin / eye.near_depth;
    float k = gaussianK(scale, tick.falloff);
    vec3 from_planes = centre, way = ray.w; // in units of the semi-axes
    if (kEllipsoids) {
        const EllipsoidAxes own = axes[particle_clipped >> 1];
        const BallOnLine ball = ballOnLine(centre, ray.w, k, own.a, own.b, own.c);
        k = ball.k, ray.closest = ball.closest, ray.b2 = ball.b2;
        from_planes = inSemiAxes(centre, own.a, own.b, own.c);
        way = inSemiAxes(ray.w, own.a, own.b, own.c);
    }
    const bool clipped = (particle_clipped & 1) != 0;
    if (kTurned && clipped) {
        const vec4 q = orientationOf(particle_clipped >> 1);
        from_planes = turnedBack(q, from_planes);
        way = turnedBack(q, way);
    }
    vec2 interval = clipped ? intervalFromPlanes(way, from_planes, scale) : per_depth / inverse_depth;
    interval = vec2(max(interval.x, ray.begin), min(interval.y, ray.end));
    if (!(interval.y > interval.x)) discard;

    const float length = interval.y - interval.x;
    const GaussianSegment segment =
        gaussianSegment(albedo_sigma.w, k, ray.b2, k * (interval.x - ray.closest), k * length);
    const float depth = kFading ? segment.depth : albedo_sigma.w * length;
    if (kEarlyReturn != kReturnNone && depth < leastDepth()) discard;

    float scattered = 0;
    if (kQuadrature == 1) {
        for (int i = 0; i < kSteps; ++i) {
            ScatterNode node = transmittanceNode(segment, i, kSteps);
            if (!kFading) {
                node.weight = legendreWeight(i, kSteps) * opacity(depth);
                node.z = length * depthPart(depth, legendreNode(i, kSteps));
            }
            scattered += node.weight * lightArriving(ray, interval.x + node.z);
        }
    } else {
        const float light_in = lightDepthAt(ray, interval.x), light_out = lightDepthAt(ray, interval.y);
        if (kQuadrature == 2) {
            scattered = scatterAnalytic(depth, light_in, light_out);
            if (kHasCasters) scattered *= 0.5 * (visibilityAt(ray, interval.x) + visibilityAt(ray, interval.y));
        } else {
            const int nodes = kQuadrature == 3 ? 3 : 2 * kSteps + 1;
            for (int j = 0; j < nodes; ++j) {
                RuleNode rule = simpsonRule(j, kSteps);
                if (kQuadrature == 3) rule = taylorRule(j, kTaylorStep ? push.taylor_step / length : 0.0625);
                const float source = kFading ? segmentSource(segment, rule.along) : evenSource(depth, rule.along);
                float light = exp(-mix(light_in, light_out, rule.along));
                if (kHasCasters && (kQuadrature != 3 || kTaylorShadows))
                    light *= visibilityAt(ray, interval.x + length * rule.along);
                scattered += rule.weight * source * light;
            }
            // The opacity bounds Simpson's sum, whose nodes may be too far apart. The series keeps what it has too
            // much, as in the seed: only below 0 it would break the picture.
            scattered = kQuadrature == 3 ? clamp(scattered, 0, 1e30) : min(scattered, opacity(depth));
        }
    }
    if (kLegacyTerm) {
        const float middle = segment.a + 0.5 * segment.h;
        const float part = kFading ? gaussianAcross(k, ray.b2) * exp(-middle * middle) : 1;
        scattered += legacyMultiple(part, push.multiple);
    }
    radiance_transmittance = composed(ray, albedo_sigma.rgb, scattered, depth);
}

void main() {
    if (isFinished()) discard;
    else drawParticle(); // CPU drivers skip this branch, but not code after a discard
}
