#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
// Method `slabs`, second pass, per eye: the extinction of all particles in each slab of each ray, sampled at the
// slab's middle. One workgroup per tile of 8x8 rays and sheet of slabs; a lane is a slab. The rays' points on its
// plane are equally spaced. A Gaussian is then a product of two recurrences, and adding a particle to 64 rays costs
// little more than 64 multiply-adds. Sheets that lie behind all surfaces of a tile are left out.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/field.h"
#include "shaders/lib/view.glsl"

layout(local_size_x_id = kIdSheet) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;

#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Members { SlabMember members[]; };
// [quantity][tile][slab][ray / 4]: quantities of the medium (shared/field.h), 1/m. Of a sheet that is hidden or has no
// members the first number is negative, and no other is written.
layout(scalar) writeonly buffer Added { vec4 added[]; };
layout(scalar) readonly buffer Bins { uint bins[]; };    // written by slab_bins.comp
layout(scalar) readonly buffer Field { float field[]; }; // with objects: what ray_ends.comp has written

layout(push_constant, scalar) uniform Push {
    uint sheets;     // z of workgroups: views, then quantities, then sheets; a view may have fewer sheets
    uint quantities; // of the medium
} push;

const uint kLanes = gl_WorkGroupSize.x;
// -log2 of a Gaussian's part of its peak, on planes beyond which a tile's width does not matter to it.
const float kMostFade = 20;

#include "shaders/lib/frustum.glsl"
#include "shaders/lib/spread.glsl"
#include "shaders/lib/tile_members.glsl"
#include "shaders/lib/field_planes.glsl"

// True if no ray of the tile reads the sheet: it begins behind the last face that pixels read.
bool isHidden(uvec2 tile, uint sheet) {
    if (!kHasOpaque) return false;
    const uint last = uint(field[fieldKept(tile) + 1]);
    return last == 0 || frontSlabs() + sheet * kLanes >= last + kSlabsAhead;
}

void main() {
    const uvec2 spread = spreadRows(), tile = uvec2(gl_WorkGroupID.x, spread.x);
    const uint view = spread.y / (push.sheets * push.quantities);
    const uint sheet = spread.y % push.sheets, quantity = spread.y / push.sheets % push.quantities;
    enterView(view);
    if (any(greaterThanEqual(uvec3(tile, sheet), grid.lines))) return; // true for the whole workgroup
    const uint bits = views[view].bins, first_member = views[view].members;
    const uint lane = gl_LocalInvocationIndex;
    const float pixel = 2 * eye.tan_y / float(eye.size.y); // m per m of view depth
    const uvec2 first = tile * kSlabTile;
    const vec2 corner = pictureCorner() +
                        ((vec2(first) + vec2(0, grid.first_row) - float(grid.margin)) * float(grid.rate) + 0.5) * pixel;
    const float z = middleDepth(sheet * kLanes + lane); // of the lane's slab
    const vec2 at = z * corner;
    const float spacing = z * pixel * float(grid.rate);
    const float last = middleDepth(sheet * kLanes + kLanes - 1); // depth of the sheet's last slab

    const uvec3 line = uvec3(tile, sheet) + uvec3(0, grid.lines.x, grid.lines.x + grid.lines.y);
    const uint words = isHidden(tile, sheet) ? 0 : (tick.particle_count + 31) / 32;

    float sum[kPoints];
    [[unroll]] for (uint r = 0; r < kPoints; ++r) sum[r] = 0;
    bool has_members = false;
    for (uint chunk = 0; chunk < words; chunk += kChunk) {
        if (!hasMembers(bits, chunk / kPage, line, grid.lines.x + grid.lines.y + grid.lines.z, words)) continue;
        const uint count = listMembers(bits, chunk, line, words);
        has_members = has_members || count > 0;
        // Each lane of the subgroup loads one member, then all lanes add it. On CPU drivers, uniform loads inside
        // loops are as slow as scattered ones.
        for (uint base = 0; base < count; base += held()) {
            SlabMember mine = SlabMember(vec3(0), 0, 0, 0, vec3(0));
            if (base + gl_SubgroupInvocationID < count)
                mine = members[first_member + list[base + gl_SubgroupInvocationID]];
            if (quantity >= kScattering) mine.sigma *= mine.albedo[quantity - kScattering];
            const float reached = mine.centre.z + sqrt(kMostFade / mine.along);
            const float widest = clamp(reached, 0, last) * pixel * float(grid.rate) * float(kSlabTile);
            addMembers(sum, mine, min(held(), count - base), vec3(at, z), spacing, widest);
        }
        barrier();
    }
    const uint tiles = grid.lines.x * grid.lines.y;
    const uint out_at =
        views[view].added +
        ((quantity * tiles + tile.y * grid.lines.x + tile.x) * grid.slabs + sheet * kLanes + lane) * (kPoints / 4);
    if (!has_members) {
        if (quantity == 0 && lane == 0) added[out_at].x = -1;
        return;
    }
    [[unroll]] for (uint r = 0; r < kPoints; r += 4) added[out_at + r / 4] =
        vec4(sum[r], sum[r + 1], sum[r + 2], sum[r + 3]);
}
