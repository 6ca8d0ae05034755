// Lists the particles (members) of a tile from the bits of lib/line_bins_write.glsl, and adds them to the 8x8 points
// of the tile on a lane's plane. These points are equally spaced. A Gaussian is then a product of two recurrences,
// and adding a particle to 64 points costs little more than 64 multiply-adds. Include after `readonly buffer Bins {
// uint bins[]; }` and kLanes, the lanes of the workgroup.

#include "shaders/lib/line_pages.glsl"

const uint kPoints = kSlabTile * kSlabTile;
const uint kWords = kPage / kLanes; // words of 32 particles that a lane reads at a time
const uint kChunk = kLanes * kWords;
// Number of members that a subgroup holds, one per lane. A subgroup may be larger than the workgroup.
uint held() { return min(gl_SubgroupSize, kLanes); }
// Most -log2 of a Gaussian across a tile, for recurrences: 2^-80 squared is still a float32.
const float kMostSpread = 80;

shared uint list[kChunk * 32];
shared uint found[kLanes];

// True if, by the pages, particles of a page may be on all three lines. Bits begin at bins[from]. `lines`: number of
// lines.
bool hasMembers(uint from, uint page, uvec3 line, uint lines, uint words) {
    const uint part = page / 32;
    return ((bins[from + pageWord(line.x, part, lines, words)] & bins[from + pageWord(line.y, part, lines, words)] &
             bins[from + pageWord(line.z, part, lines, words)]) >> (page % 32) & 1) != 0;
}

// Writes to `list`, in order, the particles of words chunk ... chunk + kChunk that are on all three lines. Returns
// their number. A barrier must follow before the next call.
uint listMembers(uint from, uint chunk, uvec3 line, uint words) {
    const uint lane = gl_LocalInvocationIndex;
    uint bits[kWords];
    uint mine = 0;
    [[unroll]] for (uint w = 0; w < kWords; ++w) {
        const uint word = chunk + lane * kWords + w;
        bits[w] = 0;
        if (word < words)
            bits[w] = bins[from + line.x * words + word] & bins[from + line.y * words + word] &
                      bins[from + line.z * words + word];
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
        for (; bits[w] != 0; bits[w] &= bits[w] - 1)
            list[before++] = (chunk + lane * kWords + w) * 32 + findLSB(bits[w]);
    barrier();
    return count;
}

// Ratio of a recurrence's first two values. A member may be far from a tile on planes that it does not reach. Its
// values are 0 there, and a ratio that is infinite would make them NaN.
float firstRatio(float exponent) { return exp2(min(exponent, 100)); }

// exp(-k^2 |d|^2) of a member on the lane's plane; d has equal steps along columns and rows.
struct Splat {
    float columns[kSlabTile];   // values of the first row, times the extinction
    float row, row_step, ratio; // factor of the next row; its ratio to the last one; the ratio of that
};

// The member that lane `j` of the subgroup holds. `at`: the tile's first point on the lane's plane, in the units of
// SlabMember::centre.
Splat splat(SlabMember mine, uint j, vec3 at, float spacing) {
    const vec3 d = at - vec3(subgroupBroadcast(mine.centre.x, j), subgroupBroadcast(mine.centre.y, j),
                             subgroupBroadcast(mine.centre.z, j));
    const float across = subgroupBroadcast(mine.across, j), along = subgroupBroadcast(mine.along, j),
                sigma = subgroupBroadcast(mine.sigma, j);
    Splat s;
    const float spread = across * spacing * spacing;
    s.ratio = exp2(-2 * spread);
    s.row = exp2(-across * d.y * d.y);
    s.row_step = firstRatio(-across * spacing * (2 * d.y + spacing));
    const float here = sigma * exp2(-along * d.z * d.z);
    float column = here * exp2(-across * d.x * d.x);
    float column_step = firstRatio(-across * spacing * (2 * d.x + spacing));
    [[unroll]] for (uint x = 0; x < kSlabTile; ++x) {
        s.columns[x] = column;
        column *= column_step;
        column_step *= s.ratio;
    }
    return s;
}

// Adds a member without recurrences, which would start from 0 if a particle is much smaller than the tile.
void addSmall(inout float sum[kPoints], SlabMember mine, uint j, vec3 at, float spacing) {
    const vec3 d = at - vec3(subgroupBroadcast(mine.centre.x, j), subgroupBroadcast(mine.centre.y, j),
                             subgroupBroadcast(mine.centre.z, j));
    const float across = subgroupBroadcast(mine.across, j);
    const float here = subgroupBroadcast(mine.sigma, j) * exp2(-subgroupBroadcast(mine.along, j) * d.z * d.z);
    float columns[kSlabTile];
    [[unroll]] for (uint x = 0; x < kSlabTile; ++x)
        columns[x] = here * exp2(-across * (d.x + float(x) * spacing) * (d.x + float(x) * spacing));
    [[unroll]] for (uint y = 0; y < kSlabTile; ++y) {
        const float row = exp2(-across * (d.y + float(y) * spacing) * (d.y + float(y) * spacing));
        [[unroll]] for (uint x = 0; x < kSlabTile; ++x) sum[y * kSlabTile + x] += row * columns[x];
    }
}

// Adds the first `end` members of the subgroup to the points, two at a time. `widest`: size of the tile on the
// farthest plane that this lane's own member reaches, in the units of SlabMember::centre.
void addMembers(inout float sum[kPoints], SlabMember mine, uint end, vec3 at, float spacing, float widest) {
    // A subgroup of one lane has no second member to add with the first.
    if (gl_SubgroupSize < 2 || subgroupAny(mine.across * widest * widest > kMostSpread)) {
        for (uint j = 0; j < end; ++j) addSmall(sum, mine, j, at, spacing);
        return;
    }
    for (uint j = 0; j < end; j += 2) {
        const Splat one = splat(mine, j, at, spacing), two = splat(mine, j + 1, at, spacing);
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
