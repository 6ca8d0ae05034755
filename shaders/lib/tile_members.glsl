// The particles of a tile, from the bits that lib/line_bins_write.glsl wrote, and what they add to its 8x8 points on the plane of a
// lane. Points are equally spaced there, so that a Gaussian is a product of two recurrences, and adding a particle to 64 points costs
// little more than 64 multiply-adds. Include after `readonly buffer Bins { uint bins[]; }` and kLanes, the lanes of the workgroup.

#include "shaders/lib/line_pages.glsl"

const uint kPoints = kSlabTile * kSlabTile;
const uint kWords = kPage / kLanes; // of 32 particles, looked at by a lane at a time
const uint kChunk = kLanes * kWords;
// Members that the lanes of a subgroup hold, one each; a subgroup may be larger than the workgroup.
uint held() { return min(gl_SubgroupSize, kLanes); }
const float kMostSpread = 80; // log2 of a Gaussian across a tile, at most, for the recurrences: 2^-80 twice is still a float32

shared uint list[kChunk * 32];
shared uint found[kLanes];

// Whether particles of that page are on all three lines, of `lines`, as far as pages tell; bits begin at bins[from].
bool hasMembers(uint from, uint page, uvec3 line, uint lines, uint words) {
    const uint part = page / 32;
    return ((bins[from + pageWord(line.x, part, lines, words)] & bins[from + pageWord(line.y, part, lines, words)] &
             bins[from + pageWord(line.z, part, lines, words)]) >> (page % 32) & 1) != 0;
}

// Puts into `list` what of the words chunk ... chunk + kChunk is set on all three lines, in order: how many. To be followed by a
// barrier before the next call.
uint listMembers(uint from, uint chunk, uvec3 line, uint words) {
    const uint lane = gl_LocalInvocationIndex;
    uint bits[kWords];
    uint mine = 0;
    [[unroll]] for (uint w = 0; w < kWords; ++w) {
        const uint word = chunk + lane * kWords + w;
        bits[w] = 0;
        if (word < words) bits[w] = bins[from + line.x * words + word] & bins[from + line.y * words + word] & bins[from + line.z * words + word];
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
    return count;
}

// exp(-k^2 |d|^2) of a member on the lane's plane, where d steps equally along columns and rows.
struct Splat {
    float columns[kSlabTile];   // of the first row, with the extinction
    float row, row_step, ratio; // rows' factor: row, then row * row_step, whose step goes by ratio each time
};

// The member that lane `j` of the subgroup holds; `at`: the tile's first point on the lane's plane, as SlabMember::centre.
Splat splat(SlabMember mine, uint j, vec3 at, float spacing) {
    const vec3 d = at - vec3(subgroupBroadcast(mine.centre.x, j), subgroupBroadcast(mine.centre.y, j), subgroupBroadcast(mine.centre.z, j));
    const float across = subgroupBroadcast(mine.across, j), along = subgroupBroadcast(mine.along, j), sigma = subgroupBroadcast(mine.sigma, j);
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
void addSmall(inout float sum[kPoints], SlabMember mine, uint j, vec3 at, float spacing) {
    const vec3 d = at - vec3(subgroupBroadcast(mine.centre.x, j), subgroupBroadcast(mine.centre.y, j), subgroupBroadcast(mine.centre.z, j));
    const float across = subgroupBroadcast(mine.across, j);
    const float here = subgroupBroadcast(mine.sigma, j) * exp2(-subgroupBroadcast(mine.along, j) * d.z * d.z);
    float columns[kSlabTile];
    [[unroll]] for (uint x = 0; x < kSlabTile; ++x) columns[x] = here * exp2(-across * (d.x + float(x) * spacing) * (d.x + float(x) * spacing));
    [[unroll]] for (uint y = 0; y < kSlabTile; ++y) {
        const float row = exp2(-across * (d.y + float(y) * spacing) * (d.y + float(y) * spacing));
        [[unroll]] for (uint x = 0; x < kSlabTile; ++x) sum[y * kSlabTile + x] += row * columns[x];
    }
}

// Adds the first `end` members of the subgroup to the points, two at a time; `widest`: the largest tile that this lane's own member
// is added to, as SlabMember::centre.
void addMembers(inout float sum[kPoints], SlabMember mine, uint end, vec3 at, float spacing, float widest) {
    if (subgroupAny(mine.across * widest * widest > kMostSpread)) {
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
