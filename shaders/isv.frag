#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
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
#include "shaders/lib/lamps_in_particle.glsl"

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

// m from the interval's begin to where the part xi of its opacity is reached.
float placeOf(GaussianSegment segment, float depth, float length, float xi) {
    return kFading ? segmentPlace(segment, depthPart(depth, xi)) : length * depthPart(depth, xi);
}

// Opacity of a Gaussian's ends that no node's part of the interval holds: there is hardly any medium there.
const float kThinEnd = 0.05;

// Sums over n nodes in transmittance space. Returns the sun's; adds that of points and spots to `lamps`. A node stands
// for what scatters from the end of the one before it on.
float atNodes(RayParticle ray, GaussianSegment segment, vec2 interval, float depth, int n, inout vec3 lamps) {
    const float length = interval.y - interval.x, thin_end = kFading ? kThinEnd : 0;
    float sum = 0, share = 0, near;
    if (kHasLocalLights) near = placeOf(segment, depth, length, thin_end);
    for (int i = 0; i < n; ++i) {
        ScatterNode node = transmittanceNode(segment, i, n);
        if (!kFading) {
            node.weight = legendreWeight(i, n) * opacity(depth);
            node.z = length * depthPart(depth, legendreNode(i, n));
        }
        sum += node.weight * lightArriving(ray, interval.x + node.z);
        if (kHasLocalLights) {
            share += legendreWeight(i, n);
            const float far = placeOf(segment, depth, length, min(share, 1 - thin_end));
            lamps += node.weight * lampsAround(interval.x + node.z, interval.x + near, interval.x + far);
            near = far;
        }
    }
    return sum;
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

    if (kHasLocalLights) aimLamps(ray.w);
    vec3 lamps = vec3(0);
    float scattered = 0;
    if (kQuadrature == 1) {
        scattered = atNodes(ray, segment, interval, depth, kSteps, lamps);
    } else {
        const float light_in = lightDepthAt(ray, interval.x), light_out = lightDepthAt(ray, interval.y);
        if (kQuadrature == 2) {
            scattered = scatterAnalytic(depth, light_in, light_out);
            if (kHasCasters) scattered *= 0.5 * (visibilityAt(ray, interval.x) + visibilityAt(ray, interval.y));
            if (kHasLocalLights) atNodes(ray, segment, interval, depth, 2, lamps); // a lamp's light has no closed form
        } else {
            const int nodes = kQuadrature == 3 ? 3 : 2 * kSteps + 1;
            float share = 0, sources = 0; // sums of the nodes before
            for (int j = 0; j < nodes; ++j) {
                RuleNode rule = simpsonRule(j, kSteps);
                if (kQuadrature == 3) rule = taylorRule(j, kTaylorStep ? push.taylor_step / length : 0.0625);
                const float source = kFading ? segmentSource(segment, rule.along) : evenSource(depth, rule.along);
                float light = exp(-mix(light_in, light_out, rule.along));
                const float place = interval.x + length * rule.along;
                if (kHasCasters && (kQuadrature != 3 || kTaylorShadows)) light *= visibilityAt(ray, place);
                scattered += rule.weight * source * light;
                if (kHasLocalLights) {
                    const float near = kQuadrature == 3 ? place : interval.x + length * share;
                    share += rule.weight;
                    const float far = kQuadrature == 3 ? place : interval.x + length * share;
                    lamps += rule.weight * source * lampsAround(place, near, far);
                    sources += rule.weight * source;
                }
            }
            // The opacity bounds Simpson's sum, whose nodes may be too far apart. The series keeps what it has too
            // much, as in the seed: only below 0 it would break the picture.
            scattered = kQuadrature == 3 ? clamp(scattered, 0, 1e30) : min(scattered, opacity(depth));
            if (kHasLocalLights)
                lamps = kQuadrature == 3 ? clamp(lamps, 0, 1e30) : lamps * min(opacity(depth) / max(sources, 1e-30), 1);
        }
    }
    if (kLegacyTerm) {
        const float middle = segment.a + 0.5 * segment.h;
        const float part = kFading ? gaussianAcross(k, ray.b2) * exp(-middle * middle) : 1;
        scattered += legacyMultiple(part, push.multiple);
    }
    radiance_transmittance = composed(ray, albedo_sigma.rgb, scattered, depth);
    if (kHasLocalLights) radiance_transmittance.rgb += albedo_sigma.rgb * lamps;
}

void main() {
    if (isFinished()) discard;
    else drawParticle(); // CPU drivers skip this branch, but not code after a discard
}
