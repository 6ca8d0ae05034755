#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require
// Shafts, per eye: the part of the sun's light in the medium before each pixel's surface that objects do not shadow.
// A workgroup makes a tile of 16x16 pixels. It first finds the objects whose shadows these may meet. With kStep it
// computes one pixel of 4x4, and others only where those do not tell them: where the edge of a shadow passes between.
// With soft edges that is smoothed over.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdHasLobe) const bool kHasLobe = true;
layout(constant_id = kIdRate) const uint kRate = 1;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;
const uint kScatteringModel = 0; // what has scattered more than once is not looked at here
layout(constant_id = kIdStep) const uint kStep = 1; // 1 or 4
const bool kHasOpaque = true, kHasAmbient = false;

#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(scalar) writeonly buffer Sunlit { vec3 sunlit[]; }; // 0 ... 1, row by row
layout(scalar) readonly buffer Field { float field[]; };  // shared/field.h
layout(scalar) readonly buffer MeshPyramid { vec2 mesh_pyramid[]; };

#include "shaders/lib/eye.glsl"
#include "shaders/lib/medium_run.glsl"
#include "shaders/lib/face_on_ray.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/casters_met.glsl"
#include "shaders/lib/shadow_list.glsl"
#include "shaders/lib/mesh_shadow.glsl"

const float kStraight = 0.005; // of a part of the light
#include "shaders/lib/pixel_nodes.glsl"
#include "shaders/lib/spread.glsl"

shared uint met[kMostBodies / 32]; // bits of the objects whose shadows the tile may meet
shared uint furthest;              // bits of its largest view depth
shared uint has_thin;              // 1: one of these shadows may lie between nodes
shared uint node_met[kNodes * kNodes]; // a hash of the objects whose shadows each node meets
const float kThin = 1.5; // width of such a shadow, in distances of nodes

// This lane's number in the workgroup. gl_LocalInvocationIndex would be divided out anew behind each barrier.
uint laneOfTile() { return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID; }

// Finds the objects whose shadows the pixels `first` ... `last` may meet before the tile's largest view depth, among
// those of the first one's tile of rays. Called by all lanes.
void findCasters(uvec2 first, uvec2 last) {
    const uint lane = laneOfTile(), lanes = 64, casters = tick.opaque_count - tick.plane_count;
    const uint words = fieldKept(fieldNode(ivec2(first)) / kSlabTile) + kFieldKept;
    const RayCone cone = rayCone(0.5 * vec2(first + last + 1), 0.5 * length(vec2(last - first + 1)));
    const vec2 range = mediumBefore(uintBitsToFloat(furthest));
    const float thin = kThin * float(kStep) * max(length(eye.ray_right), length(eye.ray_down));
    for (uint i = lane; i < (casters + 31) / 32; i += lanes) met[i] = 0;
    if (lane == 0) has_thin = 0;
    barrier();
    for (uint i = lane; i < casters; i += lanes) {
        if ((uint(field[words + i / kWordCasters]) >> (i % kWordCasters) & 1) == 0) continue;
        const uint o = tick.plane_count + i;
        const float depth = meetsShadow(o, cone, range);
        if (depth == kMiss) continue;
        atomicOr(met[i / 32], 1u << (i % 32));
        const vec3 size = 2 * objects[o].half_size;
        if ((objects[o].kind == kSphere ? size.x : min(size.x, min(size.y, size.z))) < thin * depth) has_thin = 1;
    }
    barrier();
}

// The object that lane `j` of the subgroup holds, without its albedo.
Opaque ofLane(Opaque own, uint j) {
    Opaque o;
    o.centre = vec3(subgroupShuffle(own.centre.x, j), subgroupShuffle(own.centre.y, j),
                    subgroupShuffle(own.centre.z, j));
    o.half_size = vec3(subgroupShuffle(own.half_size.x, j), subgroupShuffle(own.half_size.y, j),
                       subgroupShuffle(own.half_size.z, j));
    o.kind = subgroupShuffle(own.kind, j);
    o.yaw_cos = subgroupShuffle(own.yaw_cos, j);
    o.yaw_sin = subgroupShuffle(own.yaw_sin, j);
    return o;
}

// Puts the parts of a ray in the medium that lie in shadow into `shadows`. `medium`: its view depths; x > y: none.
// Returns a hash of the objects that throw them, and of how many shadows there are of meshes. Called by all lanes: each
// loads one object, for all.
uint findShadows(vec3 dir, vec2 medium) {
    const uint lanes = min(gl_SubgroupSize, 32);
    uint hash = 0;
    shadow_count = 0;
    for (uint word = 0; word < (tick.opaque_count - tick.plane_count + 31) / 32; ++word)
        for (uint first = 0; first < 32; first += lanes) {
            uint bits = met[word] >> first & (0xffffffffu >> (32 - lanes));
            if (bits == 0) continue;
            const uint of_first = tick.plane_count + 32 * word + first;
            Opaque own;
            if (gl_SubgroupInvocationID < lanes && (bits >> gl_SubgroupInvocationID & 1) != 0)
                own = objects[of_first + gl_SubgroupInvocationID];
            do { // the condition is at the end: see lib/tile_members.glsl
                const uint j = findLSB(bits);
                bits &= bits - 1;
                vec2 range = shadowOf(ofLane(own, j), eye.position, dir);
                range = vec2(max(range.x, medium.x), min(range.y, medium.y));
                if (range.x < range.y) {
                    joinShadow(range, 0);
                    hash = (hash ^ (of_first + j)) * 0x9e3779b1u;
                }
            } while (bits != 0);
        }
    if (kHasMeshes && medium.x < medium.y) {
        walkShadowMap(eye.position, dir, medium.x, medium.y);
        hash = (hash ^ shadow_count) * 0x9e3779b1u;
    }
    return hash;
}

// The quantities of the sun's light between two view depths; 0: the others.
void sunOn(vec2 range, vec3 dir, FieldRun run, float part, out float light[kMostFieldQuantities]) {
    [[dont_unroll]] for (uint q = 0; q < fieldQuantities(); ++q) light[q] = 0;
    if (isFogOnly()) {
        const vec3 fog = lightOfLoneFog(dir, range);
        for (uint c = 0; c < 3; ++c) light[fieldFog() + c] = fog[c];
        return;
    }
    const vec2 faces = kHasFog ? vec2(faceOnRay(range.x, dir), faceOnRay(range.y, dir)) : facesAt(range);
    uint n = 0;
    [[dont_unroll]] do {
        const uint q = n < kSunColours ? kFieldSun + n : fieldFog() + n - kSunColours;
        light[q] = fieldBetween(q, run, faces.y, part) - fieldBetween(q, run, faces.x, part);
    } while (++n < kSunColours + (kHasFog ? 3 : 0));
}

// The part of the light of a pixel's ray up to view depth `end` that objects do not shadow. Called by all lanes.
// `wanted`: true for lanes whose pixel is asked for; the others get 1.
vec3 ofPixel(ivec2 pixel, float end, bool wanted, out uint hash) {
    const vec3 dir = rayDirection(vec2(pixel) + 0.5);
    const vec2 medium = wanted ? mediumBefore(end) : vec2(1, 0);
    hash = findShadows(dir, medium);
    if (shadow_count == 0) return vec3(1);
    // With the whole ray as one range more, what it has and what shadows take are looked up in the same way. So little
    // is left where nearly all of it is in shadow, and errors of the look-up hardly matter.
    float whole[kMostFieldQuantities], dark[kMostFieldQuantities];
    [[dont_unroll]] for (uint q = 0; q < kMostFieldQuantities; ++q) whole[q] = dark[q] = 0;
    const FieldRun run = fieldRun(pixel);
    const float part = fieldPart(pixel.x);
    uint i = 0;
    [[dont_unroll]] do {
        vec2 range = medium;
        if (i < shadow_count) range = shadows[i];
        float light[kMostFieldQuantities];
        sunOn(range, dir, run, part, light);
        [[dont_unroll]] for (uint q = kFieldSun; q < fieldQuantities(); ++q)
            if (i < shadow_count) dark[q] += light[q];
            else whole[q] = light[q];
    } while (++i <= shadow_count);
    const vec3 all = sunLight(dir, whole);
    return mix(vec3(1), clamp(1 - sunLight(dir, dark) / max(all, 1e-30), 0, 1), greaterThan(all, vec3(1e-30)));
}

// True if the nodes around a pixel of the tile meet the same shadows.
bool isBetweenEdges(uvec2 pixel) {
    const uvec2 cell = min(pixel / kStep, uvec2(kNodes - 2));
    const uint node = cell.y * kNodes + cell.x, hash = node_met[node];
    return hash == node_met[node + 1] && hash == node_met[node + kNodes] && hash == node_met[node + kNodes + 1];
}

// True if no ray has medium in the pixels `first` ... `last` of the tile, 8x8 at a time.
bool isClearTile(uvec2 first, uvec2 last) {
    bool clear = !kHasFog;
    [[dont_unroll]] for (uint i = 0; i < 4 && clear; ++i) {
        const uvec2 lo = clamp((first & ~(kPixelTile - 1)) + 8 * uvec2(i & 1, i >> 1), first, last);
        clear = isClear(fieldNode(ivec2(lo)), fieldNode(ivec2(min(lo | 7u, last))) + (kRate == 1 ? 0 : 3));
    }
    return clear;
}

void main() {
    enterView(0);
    const bool soft_edges = grid.soft_edges != 0; // True: edges are smoothed over
    const uint lane = laneOfTile();
    const uvec2 local = uvec2(lane % 8, lane / 8);
    const uvec2 tile = spreadGroup().xy * kPixelTile + uvec2(0, views[0].first / kPixelTile * kPixelTile);
    const uvec2 first = max(tile, uvec2(0, views[0].first)), end = uvec2(eye.size.x, views[0].end);
    const uvec2 last = min(tile + kPixelTile, end) - 1;
    const bool clear = isClearTile(first, last);
    const bool coarse = kStep > 1 && tile == first && all(lessThan(tile + kPixelTile, end)); // True: all nodes are seen
    if (!clear) {
        if (lane == 0) furthest = 0;
        barrier();
        for (uint y = first.y + local.y; y <= last.y + (coarse ? 1 : 0); y += 8)
            for (uint x = first.x + local.x; x <= last.x + (coarse ? 1 : 0); x += 8)
                atomicMax(furthest, floatBitsToUint(texelFetch(view_depth, ivec2(x, y), 0).r));
        barrier();
        findCasters(first, last + (coarse ? 1 : 0));
    }
    [[dont_unroll]] for (uint part = 0; part < 5; ++part) { // the nodes, then all pixels, 8x8 at a time
        const bool nodes = part == 0;
        const uvec2 quarter = uvec2((part - 1) & 1, (part - 1) >> 1);
        const uvec2 in_tile = nodes ? kStep * uvec2(lane % kNodes, lane / kNodes) :
                                      8 * quarter + local;
        const uvec2 pixel = tile + in_tile;
        const bool inside = all(lessThanEqual(pixel, last)) && pixel.y >= first.y;
        const bool made = nodes ? coarse && !clear && (soft_edges || has_thin == 0) && lane < kNodes * kNodes : inside;
        float depth = 1;
        vec3 value = vec3(1);
        uint hash = 0;
        bool wanted = false; // True: the ray's shadows are asked for
        if (made) depth = texelFetch(view_depth, ivec2(pixel), 0).r;
        bool between = false; // True: the nodes tell the value
        if (!nodes && coarse && !clear && (soft_edges || has_thin == 0)) {
            between = isBetweenNodes(in_tile, 1 / depth, value);
            between = between && isBetweenEdges(in_tile);
            if (soft_edges && !between) between = isSmoothed(in_tile, 1 / depth, value);
        }
        wanted = made && !clear && !between;
        if (subgroupAny(wanted)) {
            const vec3 sun = ofPixel(ivec2(pixel), depth, wanted, hash);
            if (wanted) value = sun;
        }
        if (made && nodes) {
            node_met[lane] = hash;
            node_value[lane] = value;
            node_inverse[lane] = 1 / depth;
        } else if (made) {
            sunlit[pixel.y * eye.size.x + pixel.x] = value;
        }
        if (nodes) barrier();
    }
}
