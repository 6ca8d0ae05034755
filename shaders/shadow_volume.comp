#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
// Volumetric shadow map, second pass: the light's optical depth at every texel of every plane. For parallel light,
// tau_L(x) = [sigma sqrt(pi)/(2k) erfc(k s)] exp(-k^2 b^2) is a product of one factor per axis. Each of kLanes lanes
// takes a particle and computes its factors for rows and planes. Then every lane adds all these particles to its own
// column of texels. Planes are summed from the light on, so that a particle costs time only at planes where its depth
// changes.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/erf.h"

layout(local_size_x_id = kIdShadowGroupLanes) in;

#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer LightParticles { LightParticle light_particles[]; };
layout(scalar) readonly buffer Bits { uint bits[]; };
layout(scalar) writeonly buffer Texels { vec4 texels[]; }; // [layer][row of the band][column]

layout(push_constant, scalar) uniform Push {
    uvec3 tiles;     // columns, rows, groups of planes
    uint words;      // words of a line
    uint first_row;  // first row of tiles of this band of the map
    uint rows;       // rows of tiles in the band
} push;

#include "shaders/lib/shadow_bins.glsl"

float of(uint lane, float value) { return subgroupShuffle(value, gl_SubgroupInvocationID / kLanes * kLanes + lane); }
uint of(uint lane, uint value) { return subgroupShuffle(value, gl_SubgroupInvocationID / kLanes * kLanes + lane); }

// Iterates over the particles of a tile and group, in order. A window is one word of bits per lane.
struct Walk {
    uint next;        // next window
    uint bits;        // this lane's word of the present window
    uint upto;        // set bits of this lane's and all lower lanes' words
    uint total, used; // set bits of the window; those already handed out
};

// Index of the n-th set bit, n from 0.
uint nthBit(uint bits, uint n) {
    uint place = 0;
    for (uint part = 16; part > 0; part /= 2) {
        const uint low = bitCount(bits >> place & ((1u << part) - 1));
        if (n >= low) {
            n -= low;
            place += part;
        }
    }
    return place;
}

// Gives each lane one of the next particles. Returns the number of lanes that got one; the others get particle 0.
uint nextParticles(inout Walk walk, uvec2 tile, uint group, uint lane, out uint particle) {
    particle = 0;
    uint filled = 0;
    while (filled < kLanes) {
        if (walk.used == walk.total) {
            if (walk.next >= push.words) break;
            const uint word = walk.next + lane;
            walk.bits =
                bits[columnWords(tile.x) + word] & bits[rowWords(tile.y) + word] & bits[groupWords(group) + word];
            walk.upto = bitCount(walk.bits);
            for (uint step = 1; step < kLanes; step *= 2) {
                const uint lower = of(max(lane, step) - step, walk.upto);
                if (lane >= step) walk.upto += lower;
            }
            walk.total = of(kLanes - 1, walk.upto);
            walk.used = 0;
            walk.next += kLanes;
        }
        const uint take = min(walk.total - walk.used, kLanes - filled), rank = walk.used + lane - filled;
        uint from = 0; // the lane whose word holds this bit
        for (uint step = kLanes / 2; step > 0; step /= 2)
            if (of(from + step - 1, walk.upto) <= rank) from += step;
        const uint word = of(from, walk.bits), before = of(from, walk.upto) - bitCount(word);
        if (lane >= filled && lane < filled + take)
            particle = particleAt(walk.next - kLanes + from, nthBit(word, rank - before));
        walk.used += take;
        filled += take;
    }
    return filled;
}

void main() {
    const uint lane = gl_SubgroupInvocationID % kLanes;
    const uint slot = gl_SubgroupID * (gl_SubgroupSize / kLanes) + gl_SubgroupInvocationID / kLanes;
    const uint id = gl_WorkGroupID.x * (gl_WorkGroupSize.x / kLanes) + slot;
    // Neighbouring workgroups get distant tiles. A CPU driver gives each core a run of workgroups, and some parts of
    // a medium are denser.
    const uint count = push.tiles.x * push.rows, index = id % 8 * ((count + 7) / 8) + id / 8;
    if (index >= count) return;
    const uvec2 tile = uvec2(index % push.tiles.x, push.first_row + index / push.tiles.x),
                first = tile * uvec2(kLanes, kRows);
    const uvec3 size = uvec3(tick.map.texels.x, min(tick.map.texels.y - push.first_row * kRows, push.rows * kRows),
                             (tick.map.slices + 1) / 3);

    float depth[kRows]; // at the last finished plane
    for (uint r = 0; r < kRows; ++r) depth[r] = 0;
    for (uint group = 0; group < push.tiles.z; ++group) {
        float added[kRows][kGroup];
        for (uint r = 0; r < kRows; ++r)
            for (uint g = 0; g < kGroup; ++g) added[r][g] = 0;

        Walk walk = Walk(0, 0, 0, 0, 0);
        for (;;) {
            uint particle;
            const uint some = nextParticles(walk, tile, group, lane, particle);
            if (some == 0) break;
            const LightParticle p = light_particles[particle];
            const float half_column = lane < some ? p.at.w : 0; // 0: that lane has no particle
            const float above = p.at.z - float(group * kGroup);
            float plane[kGroup], row[kRows];
            float before = group == 0 ? 0 : half_column * erfc(p.k.z * above);
            for (uint g = 0; g < kGroup; ++g) {
                const float here = half_column * erfc(p.k.z * (above - float(g + 1)));
                plane[g] = here - before;
                before = here;
            }
            for (uint r = 0; r < kRows; ++r) {
                const float y = p.k.y * (float(first.y + r) - p.at.y);
                row[r] = exp(-y * y);
            }
            float across[kLanes][kGroup], rows[kLanes][kRows];
            for (uint l = 0; l < kLanes; ++l) {
                const float x = of(l, p.k.x) * (float(first.x + lane) - of(l, p.at.x));
                const float column = exp(-x * x);
                for (uint g = 0; g < kGroup; ++g) across[l][g] = column * of(l, plane[g]);
                for (uint r = 0; r < kRows; ++r) rows[l][r] = of(l, row[r]);
            }
            for (uint r = 0; r < kRows; ++r)
                for (uint g = 0; g < kGroup; ++g) {
                    float sum = across[0][g] * rows[0][r];
                    for (uint l = 1; l < kLanes; ++l) sum += across[l][g] * rows[l][r];
                    added[r][g] += sum;
                }
        }

        // A layer is four planes; its first is also the last of the previous layer.
        for (uint r = 0; r < kRows; ++r)
            for (uint g = 0; g < kGroup; g += 3) {
                vec4 planes = vec4(depth[r], 0, 0, 0);
                for (uint j = 0; j < 3; ++j) planes[j + 1] = planes[j] + added[r][g + j];
                depth[r] = planes.w;
                const uvec3 at = uvec3(first.x + lane, first.y + r - push.first_row * kRows, (group * kGroup + g) / 3);
                if (all(lessThan(at, size))) texels[(at.z * size.y + at.y) * size.x + at.x] = planes;
            }
    }
}
