#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Methods `slabs` and `grid`, last pass, per eye: turns the values of whole rays into the coefficients of a cubic
// B-spline through them. With rays 0.8 standard deviations apart, its error is a fourth of Catmull-Rom's. A lane is a
// node.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 64) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;

layout(scalar, binding = 2) buffer Field { float field[]; };

#include "shaders/lib/field_planes.glsl"

// Approximate inverse of the B-spline's samples (1, 4, 1) / 6, cut to five taps. Of those that keep constants, these
// have the least error for Gaussians with rays 0.25 to 0.95 standard deviations apart: 0.07 % at 0.5, 0.3 % at 0.7, a
// fourth and a half of what the taps that are exact for cubics leave (0.05, -0.3667, 1.6333).
const float kInverse[5] = {0.04439, -0.33987, 1.59096, -0.33987, 0.04439};

const float kSteep = 1;      // slabs: ends that differ by more are steep
const float kNothing = 1e-4; // optical depth: where all rays around have less, there is nothing to cut

// The 5x5 nodes around a node, row by row; nodes at the border are repeated.
void valuesAround(uvec2 node, uint plane, out float values[25]) {
    [[unroll]] for (int n = 0; n < 25; ++n) {
        const uvec2 at = uvec2(clamp(ivec2(node) + ivec2(n % 5, n / 5) - 2, ivec2(0), ivec2(grid.nodes) - 1));
        values[n] = field[plane + at.y * grid.nodes.x + at.x];
    }
}

// A ray without medium has no value of scattered light, but pixels beside it need one. Nodes that are not `known` get
// the value of the known ones around the middle.
float coefficient(float values[25], uint known) {
    float sum = 0, unknown = 0, around = 0, weights = 0;
    [[unroll]] for (int n = 0; n < 25; ++n) {
        const int i = n % 5, j = n / 5;
        const float inverse = kInverse[i] * kInverse[j], near = 1.0 / float(1 + (i - 2) * (i - 2) + (j - 2) * (j - 2));
        const bool is_known = (known >> n & 1) != 0;
        const float inverse_value = inverse * values[n], near_value = near * values[n];
        sum += is_known ? inverse_value : 0;
        unknown += is_known ? 0 : inverse;
        around += is_known ? near_value : 0;
        weights += is_known ? near : 0;
    }
    return sum + unknown * around / max(weights, 1e-6);
}

void main() {
    enterView(gl_WorkGroupID.z);
    const uint n = gl_GlobalInvocationID.x, all = 0x1ffffff;
    if (n >= fieldNodes()) return;
    const uvec2 node = uvec2(n % grid.nodes.x, n / grid.nodes.x);
    float values[25], deepest = 0;
    if (kHasOpaque && !kHasFog && isClear(max(node, 2) - 2, node + 2)) {
        for (uint q = 0; q < fieldQuantities(); ++q) field[fieldSpline(q) + n] = 0;
    } else {
        valuesAround(node, fieldWhole(kFieldDepth), values);
        uint known = 0;
        field[fieldSpline(kFieldDepth) + n] = coefficient(values, all);
        [[unroll]] for (int i = 0; i < 25; ++i) deepest = max(deepest, values[i]);
        [[unroll]] for (int i = 0; i < 25; ++i) known |= uint(values[i] > 0) << i;
        for (uint q = kFieldSun; q < fieldQuantities(); ++q) {
            valuesAround(node, fieldWhole(q), values);
            if (kHasFog) {
                known = 0;
                [[unroll]] for (int i = 0; i < 25; ++i) known |= uint(values[i] >= 0) << i;
            }
            field[fieldSpline(q) + n] = coefficient(values, known);
        }
    }
    if (kHasOpaque) {
        valuesAround(node, fieldEnd(), values);
        field[fieldEndSpline() + n] = coefficient(values, all);
        float nearest = values[0], furthest = values[0];
        [[unroll]] for (int i = 1; i < 25; ++i) {
            nearest = min(nearest, values[i]);
            furthest = max(furthest, values[i]);
        }
        field[fieldSteep() + n] = deepest > kNothing && furthest - nearest > kSteep ? 1 : 0;
    }
}
