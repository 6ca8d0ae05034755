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
layout(constant_id = kIdEllipsoids) const bool kEllipsoids = false;

layout(scalar) readonly buffer Members { SlabMember members[]; };
layout(scalar) readonly buffer Skews { Skew skews[]; }; // as members; of ellipsoids
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

uint first_member;
uint reachOf(uint particle) { return members[first_member + particle].reach; }

#include "shaders/lib/tile_lists.glsl"
#include "shaders/lib/tile_points.glsl"
#include "shaders/lib/skewed_points.glsl"
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
    const uvec3 group = spreadGroup();
    const uvec2 tile = group.xy;
    const uint view = group.z / (push.parts * push.quantities);
    const uint quantity = group.z / push.parts % push.quantities;
    enterView(view);
    const uint first_sheet = group.z % push.parts * push.together,
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
    first_member = views[view].members;
    const uint words = (tick.particle_count + 31) / 32;
    const Lines lines =
        Lines(views[view].bins, tile.x, grid.lines.x + tile.y, kNoLine, grid.lines.x + grid.lines.y, words);
    const uint sheets = sheetsRead(tile, first_sheet, end_sheet);

    uint stored = 0; // bits of the part's sheets that have been stored
    uint word = 0;
    if (sheets > 0 && words > 0) do { // once, unless there are more members than a list holds
            TileList list = listMembers(lines, word, first_sheet + uvec2(0, sheets));
            if (list.present == 0) continue;
            meetLanes();
            sortIntoSheets(list, sheets, 0);
            if (list.small) sortIntoSheets(list, sheets, kSmall);
            meetLanes();
            do {
                const uint sheet = findLSB(list.present), first_slab = (first_sheet + sheet) * kLanes;
                list.present &= list.present - 1;
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
                // Each lane loads one member, then all lanes add it. On CPU drivers, uniform loads inside loops are as
                // slow as scattered ones.
                const uint some = chooseMembers(list, sheet, 0);
                meetLanes();
                uint next = 0;
                if (some > 0) do {
                        HeldSkewed mine = kNoneSkewed;
                        if (next + lane < some) {
                            mine.member = heldMember(members[first_member + chosen[next + lane]], quantity);
                            if (kEllipsoids) mine.skew = skews[first_member + chosen[next + lane]];
                        }
                        const uint count = min(kLanes, some - next);
                        if (kEllipsoids) addAllSkewed(sum, mine, count, at, spacing);
                        else addMembers(sum, mine.member, count, at, spacing);
                        next += kLanes;
                    } while (next < some);
                if (list.small) {
                    meetLanes();
                    const uint small = chooseMembers(list, sheet, kSmall);
                    meetLanes();
                    next = 0;
                    if (small > 0) do {
                            const uint member = first_member + chosen[next];
                            const Held held = heldMember(members[member], quantity);
                            if (kEllipsoids) addSmallSkewed(sum, HeldSkewed(held, skews[member]), at, spacing);
                            else addSmall(sum, held, at, spacing);
                        } while (++next < small);
                }
                [[unroll]] for (uint r = 0; r < kPoints; r += 4) added[out_at + r / 4] =
                    vec4(sum[r], sum[r + 1], sum[r + 2], sum[r + 3]);
                meetLanes(); // the lists are free again
            } while (list.present != 0);
        } while (word < words);
    if (quantity != 0) return;
    uint sheet = lane;
    do {
        if (first_sheet + sheet < end_sheet && (stored >> sheet & 1) == 0)
            added[to_tile + (first_sheet + sheet) * kLanes * (kPoints / 4)].x = -1;
        sheet += kLanes;
    } while (first_sheet + sheet < end_sheet);
}
