#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Sphere proxies: the whole Gaussian by 2-point Gauss-Hermite; where the near plane or a wall cuts it, two points in transmittance
// space on what is left. The light depth is looked up at the nodes.
#include "shaders/shared/types.h"

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) uniform EyeBlock { Eye eye; };

layout(location = 0) flat in vec4 centre_radius;
layout(location = 1) flat in vec4 albedo_sigma;
layout(location = 2) flat in float k;

layout(location = 0) out vec4 radiance_transmittance;

#include "shaders/lib/medium_shading.glsl"

void main() {
    const RayParticle ray = rayParticle(centre_radius.xyz);
    const float half2 = centre_radius.w * centre_radius.w - ray.b2;
    if (half2 <= 0) discard;
    float depth = lineDepth(albedo_sigma.w, k, gaussianAcross(k, ray.b2));
    const ScatterNode before = hermiteNode(depth, k, 0), behind = hermiteNode(depth, k, 1);
    vec2 at = ray.closest + vec2(before.z, behind.z);
    vec2 weight = vec2(before.weight, behind.weight);
    if (kMayBeCut) { // compiled out where nothing can be cut: lanes in lockstep would pay for it
        const float half_length = sqrt(half2);
        const float begin = max(ray.closest - half_length, ray.begin), end = min(ray.closest + half_length, ray.end);
        if (!(end > begin)) discard;
        if (end - begin < 1.999 * half_length) {
            const GaussianSegment segment =
                gaussianSegment(albedo_sigma.w, k, ray.b2, k * (begin - ray.closest), k * (end - begin));
            const ScatterNode first = transmittanceNode(segment, 0, 2), second = transmittanceNode(segment, 1, 2);
            depth = segment.depth;
            at = begin + vec2(first.z, second.z);
            weight = vec2(first.weight, second.weight);
        }
    }
    const float scattered = weight.x * lightArriving(ray, at.x) + weight.y * lightArriving(ray, at.y);
    radiance_transmittance = composed(ray, albedo_sigma.rgb, scattered, depth);
}
