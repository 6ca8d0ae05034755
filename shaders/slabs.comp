#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `slabs`, second pass, per eye: the extinction of all particles in each slab of each ray, sampled at the
// slab's middle. One workgroup, which is one subgroup, per tile of 8x8 rays; a lane is a slab. It lists the particles
// (members) of the tile once. Of each sheet of slabs it then chooses its members, and adds them to the rays' points
// (lib/tile_points.glsl). Sheets that lie behind all surfaces of a tile are left out.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/field.h"
#include "shaders/lib/view.glsl"

layout(local_size_x_id = kIdLanes) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;

#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Members { SlabMember members[]; };
// [quantity][tile][slab][ray / 4]: quantities of the medium (shared/field.h), 1/m. Of a sheet that is hidden or has no
// members the first number is negative, and no other is written.
layout(scalar) buffer Added { vec4 added[]; };
layout(scalar) readonly buffer Bins { uint bins[]; };    // written by slab_bins.comp
layout(scalar) readonly buffer Field { float field[]; }; // with objects: what ray_ends.comp has written

layout(push_constant, scalar) uniform Push {
    uint parts;      // z of workgroups: views, then quantities, then parts; a view may have fewer parts
    uint together;   // sheets of a part, at most kMostTogether
    uint quantities; // of the medium
} push;

#include "shaders/lib/frustum.glsl"
#include "shaders/lib/spread.glsl"
#include "shaders/lib/tile_lists.glsl"
#include "shaders/lib/tile_points.glsl"
#include "shaders/lib/field_planes.glsl"

// Number of the workgroup's sheets that some ray of the tile reads. The others begin behind the last face that pixels
// read.
uint sheetsRead(uvec2 tile, uint first, uint end) {
    if (!kHasOpaque) return end - first;
    const uint last = uint(field[fieldKept(tile) + 1]), slabs = last == 0 ? 0 : last + kSlabsAhead;
    const uint upto = slabs <= frontSlabs() ? 0 : (slabs - frontSlabs() + kLanes - 1) / kLanes;
    return clamp(upto, first, end) - first;
}

void main() {
    const uvec2 spread = spreadRows(), tile = uvec2(gl_WorkGroupID.x, spread.x);
    const uint view = spread.y / (push.parts * push.quantities);
    const uint quantity = spread.y / push.parts % push.quantities;
    enterView(view);
    const uint first_sheet = spread.y % push.parts * push.together,
               end_sheet = min(first_sheet + push.together, grid.lines.z);
    if (any(greaterThanEqual(uvec3(tile, first_sheet), grid.lines))) return; // true for the whole workgroup
    const uint lane = gl_SubgroupInvocationID;
    const float pixel = 2 * eye.tan_y / float(eye.size.y); // m per m of view depth
    const vec2 corner =
        pictureCorner() +
        ((vec2(tile * kSlabTile) + vec2(0, grid.first_row) - float(grid.margin)) * float(grid.rate) + 0.5) * pixel;
    const uint tiles = grid.lines.x * grid.lines.y;
    const uint to_tile =
        views[view].added + (quantity * tiles + tile.y * grid.lines.x + tile.x) * grid.slabs * (kPoints / 4);
    const uint first_member = views[view].members, words = (tick.particle_count + 31) / 32, row = grid.lines.x + tile.y;
    const Lines lines = Lines(views[view].bins, tile.x, row, row, grid.lines.x + grid.lines.y, words);
    const uint sheets = sheetsRead(tile, first_sheet, end_sheet);

    uint stored = 0; // bits of the part's sheets that have been stored
    uint word = sheets > 0 ? 0 : words;
    if (word < words) do {               // once, unless there are more members than a list holds
            uint count = 0, small = 0, present = 0; // members in the list; bits of the part's sheets that they are in
            do {
                uint left = nextBits(lines, word);
                if (ballot(left != 0) != 0) do {
                        const bool some = left != 0;
                        const uint index = (word + lane) * 32 + (some ? findLSB(left) : 0);
                        left &= left - 1;
                        const uint reach = some ? members[first_member + index].reach : 1;
                        const uvec2 own = uvec2(reach & (kSmallMember - 1), reach >> 16);
                        const bool is_member = own.x <= own.y && own.x < first_sheet + sheets && own.y >= first_sheet,
                                   is_small = is_member && (reach & kSmallMember) != 0;
                        const uint found = ballot(is_member && !is_small), found_small = ballot(is_small);
                        if (is_member) {
                            const uvec2 here = clamp(own, first_sheet, end_sheet - 1) - first_sheet;
                            listed[is_small ? kMostListed - 1 - small - lanesBefore(found_small) :
                                              count + lanesBefore(found)] = packed(index, here);
                            present |= sheetBits(here);
                        }
                        count += bitCount(found);
                        small += bitCount(found_small);
                    } while (ballot(left != 0) != 0);
                word += kLanes;
            } while (word < words && hasRoom(count + small));
            present = subgroupOr(present) & (0xffffffffu >> (32 - sheets));
            meetLanes();
            sortIntoSheets(count, sheets);
            meetLanes();
            if (present != 0) do {
                    const uint sheet = findLSB(present), first_slab = (first_sheet + sheet) * kLanes;
                    present &= present - 1;
                    const float z = middleDepth(first_slab + lane); // of the lane's slab
                    const vec3 at = vec3(z * corner, z);
                    const float spacing = z * pixel * float(grid.rate);
                    const uint out_at = to_tile + (first_slab + lane) * (kPoints / 4);
                    float sum[kPoints];
                    [[unroll]] for (uint r = 0; r < kPoints; ++r) sum[r] = 0;
                    if ((stored >> sheet & 1) != 0) {
                        [[unroll]] for (uint r = 0; r < kPoints; ++r) sum[r] = added[out_at + r / 4][r % 4];
                    }
                    stored |= 1u << sheet;
                    // Each lane loads one member, then all lanes add it. On CPU drivers, uniform loads inside loops are
                    // as slow as scattered ones.
                    const uint chosen_count = chooseMembers(count, sheet);
                    meetLanes();
                    uint next = 0;
                    if (chosen_count > 0) do {
                            Held mine = kNoMember;
                            if (next + lane < chosen_count)
                                mine = heldMember(members[first_member + chosen[next + lane]], quantity);
                            addMembers(sum, mine, min(kLanes, chosen_count - next), at, spacing);
                            next += kLanes;
                        } while (next < chosen_count);
                    next = 0;
                    if (small > 0) do {
                            const uint one = listed[kMostListed - 1 - next];
                            if (isIn(one, sheet))
                                addSmall(sum, heldMember(members[first_member + indexOf(one)], quantity), at, spacing);
                        } while (++next < small);
                    [[unroll]] for (uint r = 0; r < kPoints; r += 4) added[out_at + r / 4] =
                        vec4(sum[r], sum[r + 1], sum[r + 2], sum[r + 3]);
                    meetLanes(); // the lists are free again
                } while (present != 0);
        } while (word < words);
    if (quantity != 0) return;
    uint sheet = lane;
    do {
        if (first_sheet + sheet < end_sheet && (stored >> sheet & 1) == 0)
            added[to_tile + (first_sheet + sheet) * kLanes * (kPoints / 4)].x = -1;
        sheet += kLanes;
    } while (first_sheet + sheet < end_sheet);
}
