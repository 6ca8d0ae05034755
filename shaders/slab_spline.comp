#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Slabs, last pass: what whole rays see becomes the coefficients of a cubic B-spline through it, whose error is a fourth of that of
// Catmull-Rom's where rays are 0.8 standard deviations apart. A lane is a node.
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 64) in;

layout(constant_id = 0) const bool kHasOpaque = true;
layout(constant_id = 23) const uint kRate = 2;
layout(constant_id = 24) const uint kSources = 1; // as in lib/slab_field.glsl

layout(scalar, binding = 2) buffer Field { float field[]; };

#include "shaders/lib/slab_field.glsl"

// The inverse of the B-spline's samples (1, 4, 1) / 6 but for a fifth tap's rest: exact for cubics.
const float kInverse[5] = {0.05, -0.36666667, 1.63333333, -0.36666667, 0.05};

// Rays that meet no medium scatter nothing, but what lies between them and others does: for `known` nodes only, others are as
// the known ones around the middle.
float coefficient(uvec2 node, uint plane, uint known) {
    float sum = 0, unknown = 0, around = 0, weights = 0;
    [[unroll]] for (int j = 0; j < 5; ++j)
        [[unroll]] for (int i = 0; i < 5; ++i) {
            const uvec2 at = uvec2(clamp(ivec2(node) + ivec2(i, j) - 2, ivec2(0), ivec2(grid.nodes) - 1));
            const float value = field[plane + at.y * grid.nodes.x + at.x], inverse = kInverse[i] * kInverse[j];
            const float near = 1.0 / float(1 + (i - 2) * (i - 2) + (j - 2) * (j - 2));
            const bool is_known = (known >> (5 * j + i) & 1) != 0;
            sum += is_known ? inverse * value : 0;
            unknown += is_known ? 0 : inverse;
            around += is_known ? near * value : 0;
            weights += is_known ? near : 0;
        }
    return sum + unknown * around / max(weights, 1e-6);
}

void main() {
    enterView(gl_WorkGroupID.z);
    if (gl_GlobalInvocationID.x >= fieldNodes()) return;
    const uvec2 node = uvec2(gl_GlobalInvocationID.x % grid.nodes.x, gl_GlobalInvocationID.x / grid.nodes.x);
    uint known = 0;
    [[unroll]] for (int j = 0; j < 5; ++j)
        [[unroll]] for (int i = 0; i < 5; ++i) {
            const uvec2 at = uvec2(clamp(ivec2(node) + ivec2(i, j) - 2, ivec2(0), ivec2(grid.nodes) - 1));
            known |= uint(field[fieldWhole(0) + at.y * grid.nodes.x + at.x] > 0) << (5 * j + i);
        }
    const uint all = 0x1ffffff;
    for (uint c = 0; c <= kSources; ++c) field[fieldSpline(c) + gl_GlobalInvocationID.x] = coefficient(node, fieldWhole(c), c == 0 ? all : known);
    if (kHasOpaque) field[fieldSpline(kSources + 1) + gl_GlobalInvocationID.x] = coefficient(node, fieldEnds(), all);
}
