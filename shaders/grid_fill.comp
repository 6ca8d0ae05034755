#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
// Method `grid`, second pass, once per tick: the sum of all particles at each node. One workgroup per brick; a lane
// is a plane of nodes. Bricks that no sample reads keep their old content.
#include "shaders/shared/types.h"
#include "shaders/shared/field.h"

layout(local_size_x = 8) in; // kSlabTile

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 2) readonly buffer Members { SlabMember members[]; };
// [quantity][plane][row][node / 4]: quantities of the medium (shared/field.h), 1/m
layout(scalar, binding = 3) writeonly buffer Nodes { vec4 nodes[]; };
layout(scalar, binding = 4) readonly buffer Bins { uint bins[]; };   // written by grid_bins.comp
layout(scalar, binding = 5) readonly buffer Marks { uint marks[]; }; // lib/grid_marks.glsl

layout(push_constant, scalar) uniform Push { MediumGrid medium; } push;

const uint kLanes = kSlabTile;

#include "shaders/lib/tile_members.glsl"
#include "shaders/lib/grid_marks.glsl"

void main() {
    const uvec3 bricks = push.medium.bricks;
    const uvec3 brick = uvec3(gl_WorkGroupID.xy, gl_WorkGroupID.z % bricks.z);
    const uint quantity = gl_WorkGroupID.z / bricks.z;
    if ((marks[markWord(kRead, brick)] >> (brick.x % 32) & 1) == 0) return;
    const uvec3 first = brick * kSlabTile + uvec3(0, 0, gl_LocalInvocationIndex),
                line = brick + uvec3(0, bricks.x, bricks.x + bricks.y);
    const uint words = (tick.particle_count + 31) / 32;

    float sum[kPoints];
    [[unroll]] for (uint r = 0; r < kPoints; ++r) sum[r] = 0;
    for (uint chunk = 0; chunk < words; chunk += kChunk) {
        if (!hasMembers(0, chunk / kPage, line, bricks.x + bricks.y + bricks.z, words)) continue;
        const uint count = listMembers(0, chunk, line, words);
        for (uint base = 0; base < count; base += held()) {
            SlabMember mine = SlabMember(vec3(0), 0, 0, 0, vec3(0));
            if (base + gl_SubgroupInvocationID < count) mine = members[list[base + gl_SubgroupInvocationID]];
            if (quantity >= kScattering) mine.sigma *= mine.albedo[quantity - kScattering];
            addMembers(sum, mine, min(held(), count - base), vec3(first), 1, float(kSlabTile));
        }
        barrier();
    }
    const uvec3 size = bricks * kSlabTile;
    const uint out_at = (((quantity * size.z + first.z) * size.y + first.y) * size.x + first.x) / 4;
    [[unroll]] for (uint y = 0; y < kSlabTile; ++y) {
        nodes[out_at + y * (size.x / 4)] = vec4(sum[8 * y], sum[8 * y + 1], sum[8 * y + 2], sum[8 * y + 3]);
        nodes[out_at + y * (size.x / 4) + 1] = vec4(sum[8 * y + 4], sum[8 * y + 5], sum[8 * y + 6], sum[8 * y + 7]);
    }
}
