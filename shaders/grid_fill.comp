#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_shuffle : require
// Method `grid`, second pass, once per tick: the sum of all particles at each node. First the coarse nodes are filled,
// then the others, whose sums begin with what the coarse ones interpolate to. A lane is a plane of nodes of a brick.
// A workgroup is one subgroup, of one brick. Bricks that no sample reads keep their old content.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/field.h"

layout(local_size_x_id = kIdLanes) in; // at most kSlabTile

layout(constant_id = kIdCoarse) const bool kCoarse = false;
layout(constant_id = kIdHasCoarse) const bool kHasCoarse = true;

#include "shaders/blocks/tick.glsl"
layout(constant_id = kIdEllipsoids) const bool kEllipsoids = false;

layout(scalar) readonly buffer Members { SlabMember members[]; };
layout(scalar) readonly buffer Skews { Skew skews[]; }; // as members; of ellipsoids
// [quantity][plane][row][node / 4]: quantities of the medium (shared/field.h), 1/m
layout(scalar) writeonly buffer Nodes { vec4 nodes[]; };
layout(scalar) readonly buffer Bins { uint bins[]; };   // written by grid_bins.comp
layout(scalar) readonly buffer Marks { uint marks[]; }; // lib/grid_marks.glsl
layout(scalar) readonly buffer CoarseNodes { vec4 coarse[]; }; // as nodes; only if these are not coarse

layout(push_constant, scalar) uniform Push { MediumGrid medium; } push;

#include "shaders/lib/tile_members.glsl"
#include "shaders/lib/tile_points.glsl"
#include "shaders/lib/skewed_points.glsl"
#include "shaders/lib/grid_marks.glsl"
#include "shaders/lib/spline.glsl"
#include "shaders/lib/spread.glsl"

shared uint listed[kMostListed]; // members of the brick

// Cubic B-spline at half-integers from its middle.
const float kSpline[4] = {4.0 / 6, 23.0 / 48, 1.0 / 6, 1.0 / 48};

// Sums of plane `own` of the brick begin with the coarse particles: a separable B-spline of the 7x7x7 coarse nodes
// around the brick. Node n of the brick lies at 1 + n / 2 of them, along each axis.
void addCoarse(inout float sum[kPoints], uvec3 brick, uint own, uint quantity) {
    const uvec3 size = coarseBricks() * kSlabTile;
    const uint plane = size.y * size.x / 4;
    const vec4 weights = spline(0.5 * float(own % 2));
    const uint first = (quantity * size.z + brick.z * kHalfTile) * plane +
                       (brick.y * kHalfTile * size.x + brick.x * kHalfTile) / 4;
    // In a large subgroup each lane loads one coarse plane, and takes the four that it needs from other lanes.
    const bool shared_loads = kLanes == kSlabTile;
    const uint own_plane = first + min(own, kCoarseOfTile - 1) * plane;
    [[unroll]] for (uint row = 0; row < kCoarseOfTile; ++row) {
        float along[kCoarseOfTile];
        [[unroll]] for (uint i = 0; i < kCoarseOfTile; ++i) along[i] = 0;
        const uint at = row * (size.x / 4);
        if (shared_loads) {
            const vec4 mine[2] = vec4[](coarse[own_plane + at], coarse[own_plane + at + 1]);
            [[unroll]] for (uint i = 0; i < kCoarseOfTile; ++i)
                [[unroll]] for (uint k = 0; k < 4; ++k)
                    along[i] += weights[k] * subgroupShuffle(mine[i / 4][i % 4], own / 2 + k);
        } else {
            [[unroll]] for (uint k = 0; k < 4; ++k) {
                const uint there = first + (own / 2 + k) * plane + at;
                const vec4 mine[2] = vec4[](coarse[there], coarse[there + 1]);
                [[unroll]] for (uint i = 0; i < kCoarseOfTile; ++i) along[i] += weights[k] * mine[i / 4][i % 4];
            }
        }
        float fine[kSlabTile];
        [[unroll]] for (uint x = 0; x < kSlabTile; ++x) {
            const uint c = x / 2;
            fine[x] = x % 2 == 0 ? kSpline[2] * (along[c] + along[c + 2]) + kSpline[0] * along[c + 1]
                                 : kSpline[3] * (along[c] + along[c + 3]) + kSpline[1] * (along[c + 1] + along[c + 2]);
        }
        [[unroll]] for (uint y = 0; y < kSlabTile; ++y) {
            const int half_nodes = abs(int(y) + 2 - 2 * int(row));
            if (half_nodes > 3) continue;
            [[unroll]] for (uint x = 0; x < kSlabTile; ++x) sum[y * kSlabTile + x] += kSpline[half_nodes] * fine[x];
        }
    }
}

void main() {
    const uvec3 bricks = kCoarse ? coarseBricks() : push.medium.bricks;
    // The lane's plane is numbered through all bricks and quantities.
    const uvec3 group = spreadGroup();
    const uint plane = group.z * kLanes + gl_SubgroupInvocationID,
        all_planes = bricks.z * kSlabTile, quantity = plane / all_planes;
    const uvec3 first = uvec3(group.xy * kSlabTile, plane % all_planes), brick = first / kSlabTile;
    if ((marks[markWord(kCoarse ? kReadCoarse : kRead, brick)] >> (brick.x % 32) & 1) == 0) return;
    const uint lane = gl_SubgroupInvocationID, words = (tick.particle_count + 31) / 32;
    const Lines lines = Lines(kCoarse ? lineWords(push.medium.bricks, words) : 0, brick.x, bricks.x + brick.y,
                              bricks.x + bricks.y + brick.z, bricks.x + bricks.y + bricks.z, words);

    float sum[kPoints];
    [[unroll]] for (uint r = 0; r < kPoints; ++r) sum[r] = 0;
    if (kHasCoarse && !kCoarse) addCoarse(sum, brick, first.z % kSlabTile, quantity);
    uint word = 0;
    do {
        uint count = 0;
        do {
            uint left = nextBits(lines, word);
            uint to = count + subgroupExclusiveAdd(bitCount(left));
            count += subgroupAdd(bitCount(left));
            if (ballot(left != 0) != 0) do {
                    if (left != 0) listed[to++] = (word + lane) * 32 + findLSB(left);
                    left &= left - 1;
                } while (ballot(left != 0) != 0);
            word += kLanes;
        } while (word < words && count + 32 * kLanes <= kMostListed);
        meetLanes();
        uint at = 0;
        do {
            HeldSkewed mine = kNoneSkewed;
            if (at + lane < count) {
                mine.member = heldMember(members[listed[at + lane]], quantity);
                if (kEllipsoids) mine.skew = skews[listed[at + lane]];
            }
            const uint together = min(kLanes, count - at);
            if (kEllipsoids) addAllSkewed(sum, mine, together, vec3(first), 1);
            else addMembers(sum, mine.member, together, vec3(first), 1);
            at += kLanes;
        } while (at < count);
        meetLanes();
    } while (word < words);
    const uvec3 size = bricks * kSlabTile;
    const uint out_at = (((quantity * size.z + first.z) * size.y + first.y) * size.x + first.x) / 4;
    [[unroll]] for (uint y = 0; y < kSlabTile; ++y) {
        nodes[out_at + y * (size.x / 4)] = vec4(sum[8 * y], sum[8 * y + 1], sum[8 * y + 2], sum[8 * y + 3]);
        nodes[out_at + y * (size.x / 4) + 1] = vec4(sum[8 * y + 4], sum[8 * y + 5], sum[8 * y + 6], sum[8 * y + 7]);
    }
}
