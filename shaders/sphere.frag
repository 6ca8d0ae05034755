#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Sphere proxies: the whole Gaussian by 2-point Gauss-Hermite quadrature. If the near plane or an object may cut it:
// two points at mean -+ standard deviation of the rest. The light depth is looked up at both points.
#include "shaders/shared/types.h"

#include "shaders/blocks/eye.glsl"

layout(location = 0) flat in vec4 centre_radius;
layout(location = 1) flat in vec4 albedo_sigma;
layout(location = 2) flat in float k;

layout(location = 0) out vec4 radiance_transmittance;

#include "shaders/lib/medium_shading.glsl"

void drawParticle() {
    const RayParticle ray = rayParticle(centre_radius.xyz);
    const float half2 = centre_radius.w * centre_radius.w - ray.b2;
    if (half2 <= 0) discard;
    if (!kMayBeCut && ray.closest < 0) discard; // the eye is outside: the sphere is completely in front or behind
    float depth;
    ScatterNode near, far;
    if (kMayBeCut) {
        const float half_length = sqrt(half2);
        const float begin = max(ray.closest - half_length, ray.begin), end = min(ray.closest + half_length, ray.end);
        if (!(end > begin)) discard;
        const GaussianSegment segment =
            gaussianSegment(albedo_sigma.w, k, ray.b2, k * (begin - ray.closest), k * (end - begin));
        depth = segment.depth;
        near = truncatedHermiteNode(segment, 0);
        far = truncatedHermiteNode(segment, 1);
        near.z += begin;
        far.z += begin;
    } else {
        depth = lineDepth(albedo_sigma.w, k, gaussianAcross(k, ray.b2));
        near = hermiteNode(depth, k, 0);
        far = hermiteNode(depth, k, 1);
        near.z += ray.closest;
        far.z += ray.closest;
    }
    const float scattered = near.weight * lightArriving(ray, near.z) + far.weight * lightArriving(ray, far.z);
    radiance_transmittance = composed(ray, albedo_sigma.rgb, scattered, depth);
}

void main() {
    if (isFinished()) discard;
    else drawParticle(); // CPU drivers skip this branch, but not code after a discard
}
