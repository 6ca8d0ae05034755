#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_shuffle : require
// Volumetric shadow map, second pass: the light's optical depth at every texel of every plane. For parallel light,
// tau_L(x) = [sigma sqrt(pi)/(2k) erfc(k s)] exp(-k^2 b^2) is a product of one factor per axis. One workgroup, which is
// one subgroup, per tile; a lane is a column of texels. Each lane takes a particle and computes its factors for rows
// and planes. Then every lane adds all these particles to its own column. Planes are summed from the light on, so that
// a particle costs time only at planes where its depth changes.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/erf.h"

layout(local_size_x_id = kIdLanes) in;

#include "shaders/blocks/tick.glsl"
layout(constant_id = kIdEllipsoids) const bool kEllipsoids = false;

layout(scalar) readonly buffer LightParticles { LightParticle light_particles[]; };
layout(scalar) readonly buffer LightSkews { Skew light_skews[]; }; // of ellipsoids
layout(scalar) readonly buffer Bins { uint bins[]; };  // written by shadow_particles.comp
layout(scalar) buffer Texels { vec4 texels[]; };       // [layer][row of the band][column]

layout(push_constant, scalar) uniform Push {
    uvec3 tiles;     // columns, rows, groups of planes
    uint first_row;  // first row of tiles of this band of the map
    uint rows;       // rows of tiles in the band
} push;

#include "shaders/lib/shadow_bins.glsl"

uint reachOf(uint particle) { return light_particles[particle].reach; }

#include "shaders/lib/tile_lists.glsl"

const float kLeastPart = 1e-7; // of an ellipsoid's largest depth, below which a texel gets none
// Between two planes, in units of 1 / k: up to that an ellipsoid is summed by steps (erfSteps()). They err by a
// thirtieth of what interpolating between the planes does.
const float kMostStep = 1;
const float kFarthest = 40; // of the first step's middle: beyond 11 all steps of a group are 0

float of(uint lane, float value) { return subgroupShuffle(value, lane); }

// Adds the particles of the lanes to a group of planes, in a tile whose first texel is `first`.
void addParticles(inout float added[kRows][kGroup], LightParticle p, uvec2 first, uint group) {
    const float above = p.at.z - float(group * kGroup);
    float plane[kGroup], row[kRows];
    float before = group == 0 ? 0 : p.at.w * erfc(p.k.z * above);
    for (uint g = 0; g < kGroup; ++g) {
        const float here = p.at.w * erfc(p.k.z * (above - float(g + 1)));
        plane[g] = here - before;
        before = here;
    }
    for (uint r = 0; r < kRows; ++r) {
        const float y = p.k.y * (float(first.y + r) - p.at.y);
        row[r] = exp(-y * y);
    }
    float across[kLanes][kGroup], rows[kLanes][kRows];
    for (uint l = 0; l < kLanes; ++l) {
        const float x = of(l, p.k.x) * (float(first.x + gl_SubgroupInvocationID) - of(l, p.at.x));
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

// The same of ellipsoids, of the first `count` lanes: each texel has factors of its own.
void addEllipsoids(inout float added[kRows][kGroup], LightParticle p, Skew skew, uint count, vec2 first, uint group) {
    uint l = 0;
    do {
        const float x = float(first.x + gl_SubgroupInvocationID) - of(l, p.at.x), y0 = first.y - of(l, p.at.y);
        const float xx = of(l, skew.xx), xy = of(l, skew.xy), yy = of(l, skew.yy), half_line = of(l, p.at.w);
        const float k = of(l, p.k.z), tilt = of(l, skew.tilt.y);
        const float above = of(l, p.at.z) + of(l, skew.tilt.x) * x - float(group * kGroup);
        for (uint r = 0; r < kRows; ++r) {
            const float y = y0 + float(r);
            const float part = half_line * exp(-(xx * x * x + 2 * xy * x * y + yy * y * y));
            if (part > kLeastPart * half_line) {
                const float middle = above + tilt * y; // plane of the group where half of it is passed
                if (k <= kMostStep) {
                    if (group == 0) added[r][0] += part * erfc(k * middle);
                    ErfSteps steps = erfSteps(clamp(k * (0.5 - middle), -kFarthest, kFarthest), k);
                    for (uint g = 0; g < kGroup; ++g) {
                        added[r][g] += part * steps.value;
                        steps.value *= steps.ratio;
                        steps.ratio *= steps.change;
                    }
                } else {
                    float before = group == 0 ? 0 : erfc(k * middle);
                    for (uint g = 0; g < kGroup; ++g) {
                        const float here = erfc(k * (middle - float(g + 1)));
                        added[r][g] += part * (here - before);
                        before = here;
                    }
                }
            }
        }
    } while (++l < min(count, kLanes));
}

void main() {
    const uint lane = gl_SubgroupInvocationID, id = gl_WorkGroupID.x;
    // Neighbouring workgroups get distant tiles. A CPU driver gives each core a run of workgroups, and some parts of
    // a medium are denser.
    const uint count_of_tiles = push.tiles.x * push.rows, index = id % 8 * ((count_of_tiles + 7) / 8) + id / 8;
    if (index >= count_of_tiles) return;
    const uvec2 tile = uvec2(index % push.tiles.x, push.first_row + index / push.tiles.x),
                first = tile * uvec2(kLanes, kRows);
    const uvec3 size = uvec3(tick.map.texels.x, min(tick.map.texels.y - push.first_row * kRows, push.rows * kRows),
                             (tick.map.slices + 1) / 3);
    const uint words = (tick.particle_count + 31) / 32;
    const Lines lines = Lines(0, tile.x, push.tiles.x + tile.y, kNoLine, push.tiles.x + push.tiles.y, words);

    uint word = 0;
    bool stored = false; // True: texels have the depth of earlier members
    do {                 // once, unless there are more members than a list holds
        TileList list = TileList(0, 0, false);
        if (words > 0) list = listMembers(lines, word, uvec2(0, push.tiles.z));
        meetLanes();
        if (list.present != 0) sortIntoSheets(list, push.tiles.z, 0);
        meetLanes();

        float depth[kRows]; // at the last finished plane
        for (uint r = 0; r < kRows; ++r) depth[r] = 0;
        uint group = 0;
        do {
            float added[kRows][kGroup];
            for (uint r = 0; r < kRows; ++r)
                for (uint g = 0; g < kGroup; ++g) added[r][g] = 0;
            if ((list.present >> group & 1) != 0) {
                const uint some = chooseMembers(list, group, 0);
                meetLanes();
                uint next = 0;
                do {
                    const uint member = chosen[min(next + lane, some - 1)];
                    LightParticle mine = light_particles[member];
                    if (next + lane >= some) mine.at.w = 0;
                    if (kEllipsoids) addEllipsoids(added, mine, light_skews[member], some - next, first, group);
                    else addParticles(added, mine, first, group);
                    next += kLanes;
                } while (next < some);
                meetLanes(); // the list is free again
            }
            // A layer is four planes; its first is also the last of the previous layer.
            for (uint r = 0; r < kRows; ++r)
                for (uint g = 0; g < kGroup; g += 3) {
                    vec4 planes = vec4(depth[r], 0, 0, 0);
                    for (uint j = 0; j < 3; ++j) planes[j + 1] = planes[j] + added[r][g + j];
                    depth[r] = planes.w;
                    const uvec3 at =
                        uvec3(first.x + lane, first.y + r - push.first_row * kRows, (group * kGroup + g) / 3);
                    if (all(lessThan(at, size))) {
                        const uint texel = (at.z * size.y + at.y) * size.x + at.x;
                        texels[texel] = stored ? texels[texel] + planes : planes;
                    }
                }
        } while (++group < push.tiles.z);
        stored = true;
        meetLanes();
    } while (word < words);
}
