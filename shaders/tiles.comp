#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require
// Method `tiles`, last pass, per eye: adds the splats of a tile to its pixels, near to far. A workgroup is a tile. A
// lane owns a run of pixels in a row, so that the values of a splat are computed once for the run. Each lane of a
// subgroup, of any size, loads one splat, then all lanes add it. (On CPU drivers, a load shared by all lanes is as
// slow as one load per lane.)
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/splat.h"

layout(local_size_x_id = kIdTileLanes) in;

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(rgba32f) uniform image2D radiance;
layout(scalar) readonly buffer Arguments { DrawArguments arguments; };
layout(scalar) readonly buffer Cones { SplatCone cones[]; };
layout(scalar) readonly buffer Splats { Splat splats[]; };
layout(scalar) readonly buffer Ways { SplatWay ways[]; }; // of ellipsoids
layout(scalar) readonly buffer Masks { uint masks[]; }; // [word][block]

layout(push_constant, scalar) uniform Push { SplatGrid grid; } push;

// Code for features that a scene lacks is compiled out.
layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdHasLobe) const bool kHasLobe = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;
layout(constant_id = kIdMayBeCut) const bool kMayBeCut = true;
layout(constant_id = kIdOneAlbedo) const bool kOneAlbedo = false;
layout(constant_id = kIdCached) const bool kCached = true;
layout(constant_id = kIdEllipsoids) const bool kEllipsoids = false;
layout(constant_id = kIdPixelsPerLane) const uint kPixels = 16;

#include "shaders/lib/medium_phase.glsl"
#include "shaders/lib/splat_run.glsl"
#include "shaders/lib/tiles.glsl"
#include "shaders/lib/frustum.glsl"
#include "shaders/lib/spread.glsl"

const uint kAny = 1, kCutNear = 2, kCutFar = 4, kLookedUp = 8; // what this tile needs to add a splat

// Iterates over the splats of a block, near to far: one for each lane.
struct Candidates {
    uint words, word; // words in the masks; the next word
    uint first, mine; // first of the words that the lanes hold; this lane's word
    uint bits;        // bits left of the last word
};

// Gives each lane one of the next splats. Returns the number of lanes that got one.
uint take(inout Candidates from, uint block, uint lane, uint lanes, out uint splat) {
    uint taken = 0;
    splat = 0;
    while (taken < lanes) {
        if (from.bits != 0) {
            if (lane == taken) splat = 32 * (from.word - 1) + findLSB(from.bits);
            from.bits &= from.bits - 1;
            ++taken;
        } else if (from.word < from.words) {
            if (from.word == from.first + lanes || from.word == 0) {
                from.first = from.word;
                from.mine = from.word + lane < from.words
                                ? masks[(from.word + lane) * push.grid.blocks.x * push.grid.blocks.y + block]
                                : 0;
            }
            from.bits = subgroupShuffle(from.mine, from.word - from.first);
            ++from.word;
        } else {
            break;
        }
    }
    return taken;
}

// Values of a function that is affine in the pixel, at the lane's pixels.
vec2 onRun(float value, float right, float down) { return vec2(value + first.x * right + first.y * down, right); }

void main() {
    const uvec2 corner = spreadGroup().xy * kTile;
    const uint lanes_across = kTile.x / kPixels;
    const uvec2 pixel =
        corner + uvec2(gl_LocalInvocationIndex % lanes_across * kPixels, gl_LocalInvocationIndex / lanes_across);
    const uint lane = gl_SubgroupInvocationID, lanes = subgroupBallotBitCount(subgroupBallot(true));
    first = vec2(pixel) + 0.5;
    log_cut = log2(tick.cut);
    float nearest_end = 1e30, farthest_end = 0;
    [[unroll]] for (uint p = 0; p < kPixels; ++p) {
        const vec3 d = rayAt(p);
        inverse_square[p] = 1 / dot(d, d);
        inverse_length[p] = inversesqrt(dot(d, d));
        begin[p] = eye.near_depth * length(d);
        transmittance[p] = 1;
        scattered[p] = hidden[p] = vec3(0);
        if (kHasOpaque) {
            end[p] = texelFetch(view_depth, min(ivec2(pixel) + ivec2(p, 0), ivec2(eye.size) - 1), 0).r * length(d);
            farthest_end = max(farthest_end, end[p]);
            if (end[p] > 0) {
                nearest_end = min(nearest_end, end[p]);
            } else { // finished pixel: no splat reaches the cut there, and the tile does not wait for it
                inverse_square[p] = 1e6;
                transmittance[p] = 0;
            }
        }
    }
    if (kHasOpaque) {
        const vec2 mine = vec2(nearest_end, farthest_end);
        for (uint l = 0; l < lanes; ++l) {
            nearest_end = min(nearest_end, subgroupShuffle(mine.x, l));
            farthest_end = max(farthest_end, subgroupShuffle(mine.y, l));
        }
    }
    const PixelCone cone = pixelCone(corner, corner + kTile);
    const float last_begin = eye.near_depth * length(vec3(abs(pictureMiddle()) + pictureHalf(), 1));

    const uvec2 block = corner / push.grid.block;
    Candidates candidates = Candidates((arguments.instance_count + 31) / 32, 0, 0, 0, 0);
    for (bool more = !kHasOpaque || farthest_end > 0; more;) {
        uint candidate;
        const uint taken = take(candidates, block.y * push.grid.blocks.x + block.x, lane, lanes, candidate);
        more = taken == lanes;
        bool meets = false;
        if (lane < taken) {
            const SplatCone splat = cones[candidate];
            const vec3 apart = splat.direction - cone.direction;
            const float reach = splat.chord + cone.chord;
            meets = dot(apart, apart) <= reach * reach;
        }
        Splat mine;
        SplatWay way = SplatWay(vec3(0), vec3(0), vec3(0));
        uint kind = 0;
        if (meets) {
            mine = splats[candidate];
            if (kEllipsoids) way = ways[candidate];
            if (kMayBeCut) {
                // Cut by the near plane, or partly behind the eye.
                if (mine.nearest < last_begin || mine.chord + 2 * cone.chord > 1.4) kind |= kCutNear;
                if (kHasOpaque && mine.nearest + 2 * mine.radius > nearest_end) kind |= kCutFar;
                if (kHasOpaque && mine.nearest > farthest_end) meets = false;
            }
            if (!kCached || mine.light >= kLookUp) kind |= kLookedUp | kAny;
            if (mine.log_line > kThin || kind == (kCutNear | kCutFar)) kind |= kAny;
        }
        const uvec4 met = subgroupBallot(meets);
        for (uint part = 0; part < lanes; part += 32)
            for (uint left = met[part / 32]; left != 0; left &= left - 1) {
                const uint from = part + findLSB(left);
                #define ITS(x) subgroupShuffle(mine.x, from)
                Run s;
                s.x = onRun(ITS(across_x.x), ITS(across_x.y), ITS(across_x.z));
                const float y = ITS(across_y.x) + first.y * ITS(across_y.y);
                s.y2 = y * y;
                s.along = onRun(ITS(along.x), ITS(along.y), ITS(along.z));
                s.log_line = ITS(log_line);
                if (kEllipsoids) {
                    #define ITS_WAY(axis)                                                                              \
                        onRun(subgroupShuffle(way.axis.x, from), subgroupShuffle(way.axis.y, from),                    \
                              subgroupShuffle(way.axis.z, from))
                    s.way = vec2[](ITS_WAY(a), ITS_WAY(b), ITS_WAY(c));
                }
                s.k = ITS(k);
                s.albedo = kOneAlbedo ? vec3(1) : vec3(ITS(albedo.x), ITS(albedo.y), ITS(albedo.z));
                s.light = kCached ? ITS(light) : 0;
                s.curvature = kCached ? ITS(curvature) / kLog2e : 0;
                s.slope = kCached ? onRun(ITS(slope.x), ITS(slope.y), ITS(slope.z)) : vec2(0);
                const uint its_kind =
                    kCached ? subgroupShuffle(kind, from) : subgroupShuffle(kind, from) | kLookedUp | kAny;
                if ((its_kind & kAny) != 0)
                    addAny(s, (its_kind & (kCutNear | kCutFar)) != 0, (its_kind & kLookedUp) != 0);
                else if (kMayBeCut && its_kind != 0)
                    addCut(s, its_kind == kCutNear ? 1 : -1);
                else
                    addThin(s);
            }
        float most = 0;
        [[unroll]] for (uint p = 0; p < kPixels; ++p) most = max(most, transmittance[p]);
        if (subgroupAll(most < push.grid.least)) more = false;
    }

    const vec3 albedo = splats[0].albedo;
    [[unroll]] for (uint p = 0; p < kPixels; ++p) {
        const ivec2 at = ivec2(pixel) + ivec2(p, 0);
        const bool finished = kHasOpaque && end[p] == 0;
        // Many thin splats may leave T at 1.
        const bool changed = !finished && (transmittance[p] < 1 || scattered[p] != vec3(0));
        if (changed && all(lessThan(at, ivec2(eye.size)))) {
            float phase = 0.07957747154594767;
            if (kHasLobe)
                phase = mediumPhase(-tick.sun.to_light, -normalize(rayAt(p)));
            vec3 medium = tick.sun.irradiance * phase * (kOneAlbedo ? albedo * scattered[p].x : scattered[p]);
            const float opaque_part = 1 - transmittance[p];
            medium += evenLight(opaque_part, kOneAlbedo ? albedo * opaque_part : hidden[p]);
            imageStore(radiance, at, vec4(medium, 0) + transmittance[p] * imageLoad(radiance, at));
        }
    }
}
