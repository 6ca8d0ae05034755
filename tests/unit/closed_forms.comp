// Every closed form once, so that the build proves that the shared headers are GLSL as well as C++.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/ellipsoid.h"
#include "shaders/shared/emission.h"
#include "shaders/shared/fog.h"
#include "shaders/shared/glass.h"
#include "shaders/shared/glow.h"
#include "shaders/shared/ground.h"
#include "shaders/shared/lit_particles.h"
#include "shaders/shared/phase.h"
#include "shaders/shared/scatter.h"
#include "shaders/shared/sky.h"
#include "shaders/shared/surface_light.h"
#include "shaders/shared/tetrahedra.h"

layout(local_size_x = 8) in;
layout(std430, set = 0, binding = 0) buffer Values { float x[]; };

void main() {
    const uint i = gl_GlobalInvocationID.x * 8;
    const GaussianSegment segment = gaussianSegment(x[i], x[i + 1], x[i + 2], x[i + 3], x[i + 4]);
    float sum = scatterAnalytic(segment.depth, x[i + 5], x[i + 6]);
    for (int j = 0; j <= 4; ++j) {
        const ScatterNode node = simpsonNode(segment, j, 2);
        sum += node.weight * node.z;
    }
    for (int j = 0; j < 3; ++j) {
        const ScatterNode node = transmittanceNode(segment, j, 3);
        const RuleNode rule = taylorRule(j, 0.0625);
        sum += node.weight * node.z + rule.weight * segmentSource(segment, rule.along) +
               evenSource(segment.depth, rule.along) + legacyMultiple(rule.along, x[i]);
    }
    for (int j = 0; j < 2; ++j) {
        const ScatterNode node = hermiteNode(segment.line, segment.k, j), cut = truncatedHermiteNode(segment, j);
        sum += node.weight * node.z + cut.weight * cut.z;
    }
    const float k = gaussianK(x[i], x[i + 1]);
    sum += lightDepth(x[i], k, gaussianAcross(k, x[i + 2]), x[i + 3]) +
           segmentDepth(x[i], k, x[i + 2], x[i + 3], x[i + 4]);
    sum += phaseOfLobes(vec3(x[i]), vec3(x[i + 1]), x[i + 2], x[i + 3], x[i + 4], x[i + 5]) +
           phaseSchlick(vec3(x[i]), vec3(x[i + 1]), x[i + 2]) + erf(x[i + 6]) + depthOfOpacity(x[i + 7]);
    const FogPart part =
        insideFog(x[i], x[i + 1], vec3(x[i + 2]), x[i + 3], vec3(x[i + 4]), vec3(x[i + 5]), 0, x[i + 6]);
    sum += fogDistance(x[i], x[i + 1], x[i + 2], x[i + 3], x[i + 4], x[i + 5], x[i + 6]);
    sum += scatterOwn(fogDepth(x[i], x[i + 1], x[i + 2], x[i + 3], x[i + 4], part.begin, part.end), x[i + 5], x[i + 6]);
    const vec3 a = groundFootprint(vec3(x[i]), vec3(x[i + 1]), x[i + 2]);
    sum += groundAlbedo(vec3(x[i]), x[i + 1], groundStructure(x[i + 2], x[i + 3], a, vec3(x[i + 4]), x[i + 5])).x;
    sum += skyZenithPart(x[i]) + skySeen(x[i]) + skyZenithSeen(x[i]);
    sum += coneDirection(1, 2, sphereEdge(x[i])).x + rectangleSolidAngle(x[i], x[i + 1], x[i + 2], x[i + 3], x[i + 4]);
    sum += glassAt(a, vec3(x[i]), vec3(x[i + 1]), vec3(x[i + 2]), vec3(x[i + 3])) + glassMirrors(x[i], x[i + 1]);
    sum += linearDepth(x[i], x[i + 1], x[i + 2]) + linearQuantile(x[i], x[i + 1], x[i + 2]);
    const LitLine lit = litLine(LitFit(x[i], a, vec3(x[i + 1]), vec3(x[i + 2])), vec3(x[i + 3]), vec3(x[i + 4]));
    const LitSums from = litSums(x[i]), to = litSums(x[i + 1]);
    const LitPart slab = litPart(x[i + 2], lit, from, to);
    const vec3 moments = litMoments(x[i], x[i + 1], x[i + 2], from);
    sum += litSlab(slab.lit, slab.depth, litEdge(litRange(moments, x[i]), x[i + 1]), moments) +
           litBefore(moments, a, x[i]);
    sum += emitted(a, vec3(x[i]), x[i + 1], vec3(x[i + 2])).x + irradianceOf(x[i], a, vec3(x[i + 1]));
    x[i] = sum;
}
