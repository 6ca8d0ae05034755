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
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;

layout(scalar) buffer Field { float field[]; };

#include "shaders/lib/field_planes.glsl"

// Approximate inverse of the B-spline's samples (1, 4, 1) / 6, cut to five taps. Of those that keep constants, these
// have the least error for Gaussians with rays 0.25 to 0.95 standard deviations apart: 0.07 % at 0.5, 0.3 % at 0.7, a
// fourth and a half of what the taps that are exact for cubics leave (0.05, -0.3667, 1.6333).
// By the distance from the middle.
const float kInverse[3] = {1.59096, -0.33987, 0.04439};

const float kSteep = 1;      // slabs: ends that differ by more are steep
const float kNothing = 1e-4; // optical depth: where all rays around have less, there is nothing to cut

// What the 5x5 nodes around a node say of it.
struct Around {
    float coefficient;
    float least, most; // values of these nodes
    uint positive;     // a bit for each node, row by row; 1: its value is positive
};

// Nodes at the border are repeated. A ray without medium has no value of scattered light, but pixels beside it need
// one. Nodes that are not `known` get the value of the known ones around the middle. With fog the values of light say
// by their sign whether they are known, and `known` is not read.
Around around(uvec2 node, uint plane, uint known, bool by_sign) {
    Around result = Around(0, 1e30, -1e30, 0);
    float sum = 0, unknown = 0, near_sum = 0, weights = 0;
    [[dont_unroll]] for (int n = 0; n < 25; ++n) { // unrolled it takes seven times as long to compile
        const int i = n % 5 - 2, j = n / 5 - 2;
        const uvec2 at = uvec2(clamp(ivec2(node) + ivec2(i, j), ivec2(0), ivec2(grid.nodes) - 1));
        const float value = field[plane + at.y * grid.nodes.x + at.x];
        const float inverse = kInverse[abs(i)] * kInverse[abs(j)], near = 1.0 / float(1 + i * i + j * j);
        const bool is_known = by_sign ? value >= 0 : (known >> n & 1) != 0;
        sum += is_known ? inverse * value : 0;
        unknown += is_known ? 0 : inverse;
        near_sum += is_known ? near * value : 0;
        weights += is_known ? near : 0;
        result.least = min(result.least, value);
        result.most = max(result.most, value);
        result.positive |= uint(value > 0) << n;
    }
    result.coefficient = sum + unknown * near_sum / max(weights, 1e-6);
    return result;
}

void main() {
    enterView(gl_WorkGroupID.z);
    const uint n = gl_GlobalInvocationID.x, all = 0x1ffffff;
    if (n >= fieldNodes()) return;
    const uvec2 node = uvec2(n % grid.nodes.x, n / grid.nodes.x);
    float deepest = 0;
    if (kHasOpaque && !kHasFog && isClear(max(node, 2) - 2, node + 2)) {
        for (uint q = 0; q < fieldQuantities(); ++q) field[fieldSpline(q) + n] = 0;
    } else {
        uint known = all;
        [[dont_unroll]] for (uint q = kFieldDepth; q < fieldQuantities(); ++q) {
            if (!isHeld(q)) continue;
            const Around here = around(node, fieldWhole(q), known, kHasFog && q != kFieldDepth);
            field[fieldSpline(q) + n] = here.coefficient;
            if (q == kFieldDepth) known = here.positive, deepest = here.most;
        }
    }
    if (kHasOpaque) {
        const Around here = around(node, fieldEnd(), all, false);
        field[fieldEndSpline() + n] = here.coefficient;
        field[fieldSteep() + n] = deepest > kNothing && here.most - here.least > kSteep ? 1 : 0;
    }
}
