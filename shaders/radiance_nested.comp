#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `gradients`, nested: the light at nodes between those of a grid twice as coarse. It is computed where the
// interpolation of coarser ones was wrong, and interpolated from these elsewhere. A lane is a node on multiples of
// push.level. So what tests one grid is the next one.
#include "shaders/lib/radiance_inputs.glsl"

layout(local_size_x = 64) in;

layout(scalar) buffer Values { vec4 values[]; }; // of nodes: LightSample::value
layout(scalar) buffer States { uint states[]; }; // of nodes: 1: the next grid is computed around it

#include "shaders/lib/radiance.glsl"

const uint kWhole = 2; // grids that are computed whole: the first ones

uvec3 size;
uint nodeAt(uvec3 node) { return (node.z * size.y + node.y) * size.x + node.x; }

void main() {
    size = push.lit.bricks * kSlabTile;
    const uint stride = uint(push.level), first = 1u << push.levels; // of the first grid
    const uvec3 own = (size + stride - 1) / stride;
    const uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64 + gl_LocalInvocationIndex;
    if (i >= own.x * own.y * own.z) return;
    const uvec3 node = stride * uvec3(i % own.x, i / own.x % own.y, i / (own.x * own.y));
    const uint at = nodeAt(node);
    const vec3 x = push.lit.origin + push.lit.spacing * vec3(node);
    if (stride == first) {
        values[at] = lightAt(x);
        states[at] = 0; // the next grid is computed whole, whatever this says
        atomicAdd(counts[kPlacesLit], 1);
        atomicAdd(counts[kSamplesKept], 1);
        return;
    }
    const uvec3 beside = node % (2 * stride); // 0 or stride
    if (beside == uvec3(0)) return;           // it is on the coarser grid, too
    // Nodes of that grid around it; beyond the last one is none.
    vec4 between = vec4(0);
    uint count = 0;
    bool wrong = first / stride < 1u << kWhole; // where coarser ones err, or nothing is known of that
    [[dont_unroll]] for (uint corner = 0; corner < 8; ++corner) {
        const uvec3 off = uvec3(corner & 1, corner >> 1 & 1, corner >> 2);
        if (any(greaterThan(off * stride, beside))) continue; // the same one again
        const uvec3 other = node - beside + 2 * stride * off;
        if (any(greaterThanEqual(other, size))) continue;
        const uint n = nodeAt(other);
        between += values[n];
        ++count;
        wrong = wrong || states[n] != 0;
    }
    between /= float(count);
    const uvec3 brick = node / kSlabTile;
    const bool read = push.lit.particles == 0 || (marks[markWord(kRead, brick)] >> (brick.x % 32) & 1) != 0;
    wrong = wrong && (read || stride > 1);
    if (!wrong) {
        values[at] = between;
        states[at] = 0;
        return;
    }
    const vec4 value = lightAt(x);
    values[at] = value;
    states[at] = stride > 1 && worthOf(value - between, x) > push.error ? 1 : 0;
    atomicAdd(counts[kPlacesLit], 1);
    atomicAdd(counts[kSamplesKept], 1);
}
