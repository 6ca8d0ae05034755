#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require
// Slabs, second pass: the optical depth that all particles together add to each slab of each ray, sampled at the slab's middle.
// One workgroup per tile of 8x8 rays and sheet of slabs; a lane is a slab. On its plane the rays' points are equally spaced, so
// that a Gaussian is a product of two recurrences, and adding a particle to 64 rays costs little more than 64 multiply-adds.
#include "shaders/shared/types.h"

layout(local_size_x_id = 20) in; // slabs of a sheet

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) uniform EyeBlock { Eye eye; };
layout(scalar, binding = 2) readonly buffer Members { SlabMember members[]; };
// [what][tile][slab][ray / 4], per m: extinction; with kColours also that which scatters red, green and blue
layout(scalar, binding = 3) writeonly buffer Added { vec4 added[]; };
layout(scalar, binding = 4) readonly buffer Bins { uint bins[]; };    // as in slab_bins.comp

layout(push_constant, scalar) uniform Push { SlabGrid grid; } push;

const uint kLanes = gl_WorkGroupSize.x;
const uint kRays = kSlabTile * kSlabTile;

#include "shaders/lib/line_pages.glsl"

const uint kWords = kPage / kLanes; // of 32 particles, looked at by a lane at a time

shared uint list[kLanes * kWords * 32]; // members of the tile and sheet
shared uint found[kLanes];

const float kMostSpread = 80; // log2 of a Gaussian across a tile, at most, for the recurrences: 2^-80 twice is still a float32

// exp(-k^2 |d|^2) of a member on the lane's plane, where d steps equally along columns and rows.
struct Splat {
    float columns[kSlabTile];   // of the first row, with the extinction
    float row, row_step, ratio; // rows' factor: row, then row * row_step, whose step goes by ratio each time
};

// The member that lane `j` of the subgroup holds; `at`: the tile's first ray on the lane's plane, m, as SlabMember::centre.
Splat splat(SlabMember mine, uint j, vec3 at, float spacing) {
    const vec3 d = at - vec3(subgroupShuffle(mine.centre.x, j), subgroupShuffle(mine.centre.y, j), subgroupShuffle(mine.centre.z, j));
    const float across = subgroupShuffle(mine.across, j), along = subgroupShuffle(mine.along, j), sigma = subgroupShuffle(mine.sigma, j);
    Splat s;
    const float spread = across * spacing * spacing;
    s.ratio = exp2(-2 * spread);
    s.row = exp2(-across * d.y * d.y);
    s.row_step = exp2(-across * spacing * (2 * d.y + spacing));
    const float here = sigma * exp2(-along * d.z * d.z);
    float column = here * exp2(-across * d.x * d.x);
    float column_step = exp2(-across * spacing * (2 * d.x + spacing));
    [[unroll]] for (uint x = 0; x < kSlabTile; ++x) {
        s.columns[x] = column;
        column *= column_step;
        column_step *= s.ratio;
    }
    return s;
}

// The same without recurrences, which would start from nothing where a particle is much smaller than the tile.
void addSmall(inout float sum[kRays], SlabMember mine, uint j, vec3 at, float spacing) {
    const vec3 d = at - vec3(subgroupShuffle(mine.centre.x, j), subgroupShuffle(mine.centre.y, j), subgroupShuffle(mine.centre.z, j));
    const float across = subgroupShuffle(mine.across, j);
    const float here = subgroupShuffle(mine.sigma, j) * exp2(-subgroupShuffle(mine.along, j) * d.z * d.z);
    float columns[kSlabTile];
    [[unroll]] for (uint x = 0; x < kSlabTile; ++x) columns[x] = here * exp2(-across * (d.x + float(x) * spacing) * (d.x + float(x) * spacing));
    [[unroll]] for (uint y = 0; y < kSlabTile; ++y) {
        const float row = exp2(-across * (d.y + float(y) * spacing) * (d.y + float(y) * spacing));
        [[unroll]] for (uint x = 0; x < kSlabTile; ++x) sum[y * kSlabTile + x] += row * columns[x];
    }
}

void main() {
    const SlabGrid grid = push.grid;
    const uint lane = gl_LocalInvocationIndex;
    const float pixel = 2 * eye.tan_y / float(eye.size.y); // m per m of view depth
    const uvec2 first = gl_WorkGroupID.xy * kSlabTile;
    const vec2 corner = vec2(-eye.tan_x, -eye.tan_y) + ((vec2(first) + vec2(0, grid.first_row) - 1) * float(grid.rate) + 0.5) * pixel;
    const uint sheet = gl_WorkGroupID.z % grid.lines.z, what = gl_WorkGroupID.z / grid.lines.z;
    const float z = grid.depth + (float(sheet * kLanes + lane) + 0.5) * grid.thickness; // of the lane's slab
    const vec2 at = z * corner;
    const float spacing = z * pixel * float(grid.rate);

    const uint lines = grid.lines.x + grid.lines.y + grid.lines.z;
    const uvec3 line = uvec3(gl_WorkGroupID.xy, sheet) + uvec3(0, grid.lines.x, grid.lines.x + grid.lines.y);
    const uint words = (tick.particle_count + 31) / 32;

    float sum[kRays];
    [[unroll]] for (uint r = 0; r < kRays; ++r) sum[r] = 0;
    uint pages = 0; // of 32 at a time, those with particles of this tile and sheet
    for (uint page = 0; page * kPage < words; ++page) {
        if (page % 32 == 0)
            pages = bins[pageWord(line.x, page / 32, lines, words)] & bins[pageWord(line.y, page / 32, lines, words)] &
                    bins[pageWord(line.z, page / 32, lines, words)];
        if ((pages >> (page % 32) & 1) == 0) continue;
        const uint chunk = page * kPage;
        uint bits[kWords];
        uint mine = 0;
        [[unroll]] for (uint w = 0; w < kWords; ++w) {
            const uint word = chunk + lane * kWords + w;
            bits[w] = 0;
            if (word < words) bits[w] = bins[line.x * words + word] & bins[line.y * words + word] & bins[line.z * words + word];
            mine += bitCount(bits[w]);
        }
        found[lane] = mine;
        barrier();
        uint before = 0, count = 0;
        for (uint l = 0; l < kLanes; ++l) {
            before += l < lane ? found[l] : 0;
            count += found[l];
        }
        [[unroll]] for (uint w = 0; w < kWords; ++w)
            for (; bits[w] != 0; bits[w] &= bits[w] - 1) list[before++] = (chunk + lane * kWords + w) * 32 + findLSB(bits[w]);
        barrier();
        // A lane of the subgroup loads a member, all add it: uniform loads inside loops are as slow as scattered ones on CPU drivers.
        for (uint base = 0; base < count; base += gl_SubgroupSize) {
            SlabMember mine = SlabMember(vec3(0), 0, 0, 0, vec3(0));
            if (base + gl_SubgroupInvocationID < count) mine = members[list[base + gl_SubgroupInvocationID]];
            if (what > 0) mine.sigma *= mine.albedo[what - 1];
            const uint end = min(gl_SubgroupSize, count - base);
            // Where exp(-k^2 d^2) across a tile would leave float32, from the farthest of its planes that the member reaches.
            const float widest = max(mine.centre.z, 0) * pixel * float(grid.rate) * float(kSlabTile);
            if (subgroupAny(mine.across * widest * widest > kMostSpread)) {
                for (uint j = 0; j < end; ++j) addSmall(sum, mine, j, vec3(at, z), spacing);
                continue;
            }
            for (uint j = 0; j < end; j += 2) {
                const Splat one = splat(mine, j, vec3(at, z), spacing), two = splat(mine, j + 1, vec3(at, z), spacing);
                float row_one = one.row, row_two = two.row, step_one = one.row_step, step_two = two.row_step;
                [[unroll]] for (uint y = 0; y < kSlabTile; ++y) {
                    [[unroll]] for (uint x = 0; x < kSlabTile; ++x)
                        sum[y * kSlabTile + x] += row_one * one.columns[x] + row_two * two.columns[x];
                    row_one *= step_one;
                    row_two *= step_two;
                    step_one *= one.ratio;
                    step_two *= two.ratio;
                }
            }
        }
        barrier();
    }
    const uint tile = gl_WorkGroupID.y * grid.lines.x + gl_WorkGroupID.x;
    const uint tiles = grid.lines.x * grid.lines.y;
    const uint out_at = ((what * tiles + tile) * grid.slabs + sheet * kLanes + lane) * (kRays / 4);
    [[unroll]] for (uint r = 0; r < kRays; r += 4) added[out_at + r / 4] = vec4(sum[r], sum[r + 1], sum[r + 2], sum[r + 3]);
}
