#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// The shared shadow grid: which lights reach a voxel past objects. A workgroup is a brick, a lane a row of voxels. Only
// what some eye sees is made, and only what is older than lights and objects.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/shadow_grid.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/meshes.glsl"
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) uniform GridBlock { ShadowGridBlock shadow_grid; };
layout(scalar) buffer Voxels { uint shadow_voxels[]; };
// Of each brick the versions of its even and odd layers; 0: never made.
layout(scalar) buffer States { uvec2 states[]; };
// With bits: of each brick a bit for each voxel that is made, 16 words [z][y / 4], bits [y % 4][x].
layout(scalar) buffer Masks { uint masks[]; };
layout(scalar) readonly buffer Eyes { ShadowEye eyes[]; };
layout(scalar) buffer Counter { uint rays_traced; };

layout(push_constant, scalar) uniform Push { ShadowGridPush push; };

#include "shaders/lib/objects.glsl"
#include "shaders/lib/object_tree.glsl"
#include "shaders/lib/mesh.glsl"
#include "shaders/lib/occluded.glsl"
#include "shaders/lib/shadow_grid.glsl"

// What a brick is to a light.
const uint kLit = 0, kDark = 1, kMixed = 2;

shared uint rays_of_group, solids;
shared uint classes[kMostShadowSlots];
shared uint made_before[16], made_now[16];

// True if the cube of this half width may lie in some eye's field of view.
bool isSeen(vec3 middle, float half_width) {
    if (push.eyes > kMostShadowEyes) return true;
    [[dont_unroll]] for (uint e = 0; e < push.eyes; ++e) {
        bool inside = true;
        [[dont_unroll]] for (uint i = 0; i < 6; ++i) {
            const vec4 plane = eyes[e].planes[i];
            inside = inside && dot(plane.xyz, middle) + plane.w >= -half_width * dot(abs(plane.xyz), vec3(1));
        }
        if (inside) return true;
    }
    return false;
}

vec3 towardLight(ShadowSlot light, vec3 x) { return light.local != 0 ? light.to - x : kSunAway * light.to; }

// True if a box or a sphere may meet the brick.
bool hasSolids(vec3 lo, vec3 hi) {
    const uint count = objectNodes();
    [[dont_unroll]] for (uint i = 0; i < count;) {
        const ObjectNode node = object_nodes[i];
        const bool met = all(lessThanEqual(node.lo, hi)) && all(greaterThanEqual(node.hi, lo));
        if (met && node.object != kInnerNode) return true;
        i = met ? i + 1 : node.next;
    }
    return false;
}

// True if the object hides the light from all corners of the brick, and so from all places in it that are not in the
// object: the shadow of a convex body is convex.
bool hidesBrick(Opaque o, ShadowSlot light, vec3 lo, vec3 hi) {
    vec3 n;
    [[dont_unroll]] for (uint i = 0; i < 8; ++i) {
        const vec3 corner = mix(lo, hi, bvec3((i & 1) != 0, (i & 2) != 0, (i & 4) != 0));
        if (!(hitObject(o, corner, towardLight(light, corner), n) < 1)) return false;
    }
    return true;
}

uint classOf(ShadowSlot light, vec3 lo, vec3 hi) {
    const vec3 middle = 0.5 * (lo + hi), to_bound = light.bound - middle;
    // Larger by a thousandth, for roundings.
    const float radius = 0.5005 * length(hi - lo);
    if (light.local != 0 && light.reach < 1e15 &&
        dot(to_bound, to_bound) > (light.reach + 2 * radius) * (light.reach + 2 * radius))
        return kLit; // where it sends nothing, no one asks
    const vec3 dir = towardLight(light, middle), inverse = inverseOf(dir);
    bool met_any = false;
    [[dont_unroll]] for (uint o = 0; o < tick.plane_count; ++o) {
        const float height = objects[o].centre.y, rounding = 1e-3 * shadow_grid.voxel;
        const bool below = hi.y < height - rounding;
        const bool light_above = light.local != 0 ? light.to.y > height + rounding : light.to.y >= 0;
        if (below || light_above) continue;
        if (hidesBrick(objects[o], light, lo, hi)) return kDark;
        met_any = true;
    }
    vec3 n;
    const uint count = objectNodes();
    [[dont_unroll]] for (uint i = 0; i < count;) {
        ObjectNode node = object_nodes[i];
        node.lo -= radius;
        node.hi += radius;
        const bool met = passes(node, middle, inverse);
        if (met && node.object != kInnerNode) {
            met_any = true;
            if (hidesBrick(objects[node.object], light, lo, hi)) return kDark;
        }
        i = met ? i + 1 : node.next;
    }
    if (met_any) return kMixed;
    if (!kHasMeshes || tick.triangle_count == 0) return kLit;
    const float distance = length(dir);
    const MeshRay ray = meshRay(middle, dir / max(distance, 1e-20));
    const uint last = ray.first + meshNodes();
    [[dont_unroll]] for (uint i = ray.first; i < last;) {
        const ObjectNode node = mesh_nodes[i];
        const vec2 range = rangeIn(node, ray, radius);
        const bool met = max(range.x, 0) <= min(range.y, distance);
        if (met && node.object != kInnerNode) return kMixed;
        i = met ? i + 1 : node.next;
    }
    return kLit;
}

// Eight bits of a row of a mask.
uint rowOf(uint word, uint y) { return word >> (8 * (y & 3)) & 255; }

void makeBits(uint at, vec3 lo, bvec2 renew) {
    const uint lane = gl_LocalInvocationIndex, y = lane % 8, z = lane / 8, word = lane / 4;
    if (lane < 16) {
        const bool fresh = (lane / 2 & 1) == 0 ? !renew.x : !renew.y; // two words are a layer
        made_before[lane] = fresh ? masks[16 * at + lane] : 0;
        made_now[lane] = made_before[lane];
    }
    barrier();
    const uint before = rowOf(made_before[word], y);
    if (before != 255) {
        const uint from = 128 * at + 2 * lane;
        uvec2 row = uvec2(shadow_voxels[from], shadow_voxels[from + 1]);
        uint now = before, rays = 0;
        // Looked up linearly, a voxel reaches as far as to the middles of its neighbours.
        const float reach = (shadow_grid.linear != 0 ? 1.01 : 0.51) * shadow_grid.voxel;
        [[dont_unroll]] for (uint i = 0; i < 8; ++i) {
            const vec3 x = lo + (vec3(i, y, z) + 0.5) * shadow_grid.voxel;
            if ((before >> i & 1) != 0 || !isSeen(x, reach)) continue;
            uint bits = 0;
            if (!isInSolid(x)) {
                [[dont_unroll]] for (uint s = 0; s < shadow_grid.slots; ++s)
                    if (!isOccluded(x, towardLight(shadow_grid.lights[s], x))) bits |= 1u << s;
                rays += shadow_grid.slots;
            }
            const uint shift = 8 * (i & 3);
            if (i < 4) row.x = row.x & ~(255u << shift) | bits << shift;
            else row.y = row.y & ~(255u << shift) | bits << shift;
            now |= 1u << i;
        }
        shadow_voxels[from] = row.x;
        shadow_voxels[from + 1] = row.y;
        atomicOr(made_now[word], now << (8 * (y & 3)));
        atomicAdd(rays_of_group, rays);
    }
    barrier();
    if (lane < 16) masks[16 * at + lane] = made_now[lane];
}

void makeCoverage(uint at, vec3 lo, bvec2 renew) {
    const uint lane = gl_LocalInvocationIndex, y = lane % 8, z = lane / 8;
    const vec3 hi = lo + float(kShadowBrick) * shadow_grid.voxel;
    if (lane < shadow_grid.slots) classes[lane] = classOf(shadow_grid.lights[lane], lo, hi);
    if (lane == kMostShadowSlots) solids = hasSolids(lo, hi) ? 1 : 0;
    barrier();
    if ((z & 1) == 0 ? renew.x : renew.y) {
        uint rays = 0;
        uvec2 lit_all = uvec2(0), mixed = uvec2(0); // a byte for each slot
        [[dont_unroll]] for (uint s = 0; s < shadow_grid.slots; ++s) {
            uint is = classes[s];
            if (is == kDark && solids != 0) is = kMixed;
            const uint one = 1u << (8 * (s & 3));
            if (s < 4) lit_all.x += is == kLit ? one : 0, mixed.x += is == kMixed ? one : 0;
            else lit_all.y += is == kLit ? one : 0, mixed.y += is == kMixed ? one : 0;
        }
        const uint words = shadow_grid.stride / 4;
        [[dont_unroll]] for (uint i = 0; i < 8; ++i) {
            uvec2 value = kLitVoxel * lit_all;
            if (mixed != uvec2(0)) {
                uvec2 lit = uvec2(0);
                uint free = 0;
                [[dont_unroll]] for (uint sub = 0; sub < 8; ++sub) {
                    const vec3 place = vec3(sub & 1, sub >> 1 & 1, sub >> 2) * 0.5 + 0.25;
                    const vec3 x = lo + (vec3(i, y, z) + place) * shadow_grid.voxel;
                    if (solids != 0 && isInSolid(x)) continue;
                    ++free;
                    [[dont_unroll]] for (uint s = 0; s < shadow_grid.slots; ++s) {
                        const uint shift = 8 * (s & 3);
                        if (((s < 4 ? mixed.x : mixed.y) >> shift & 1) == 0) continue;
                        ++rays;
                        const uint one = isOccluded(x, towardLight(shadow_grid.lights[s], x)) ? 0 : 1u << shift;
                        if (s < 4) lit.x += one;
                        else lit.y += one;
                    }
                }
                [[dont_unroll]] for (uint s = 0; s < kMostShadowSlots; ++s) {
                    const uint shift = 8 * (s & 3), count = (s < 4 ? lit.x : lit.y) >> shift & 255;
                    const uint byte = free == 0 ? kSolidVoxel : (kLitVoxel * count + free / 2) / free;
                    const bool is_mixed = ((s < 4 ? mixed.x : mixed.y) >> shift & 1) != 0;
                    if (!is_mixed && free != 0) continue;
                    if (s < 4) value.x = value.x & ~(255u << shift) | byte << shift;
                    else value.y = value.y & ~(255u << shift) | byte << shift;
                }
            }
            const uint to = (512 * at + 8 * lane + i) * words;
            shadow_voxels[to] = value.x;
            if (words > 1) shadow_voxels[to + 1] = value.y;
        }
        atomicAdd(rays_of_group, rays);
    }
}

void main() {
    const uint at = shadowBrickAt(gl_WorkGroupID), lane = gl_LocalInvocationIndex;
    const vec3 lo = shadow_grid.origin + float(kShadowBrick) * shadow_grid.voxel * vec3(gl_WorkGroupID);
    const uvec2 made = states[at];
    // A layer that may wait for the next call was made for lights and objects of the call before.
    const bvec2 old = notEqual(made, uvec2(push.version));
    const bvec2 must = bvec2(made.x == 0 || made.x + 1 < push.version, made.y == 0 || made.y + 1 < push.version);
    const bvec2 renew = bvec2(old.x && (must.x || push.layer != 1), old.y && (must.y || push.layer != 0));
    if (shadow_grid.coverage != 0 && !any(renew)) return;
    if (!isSeen(lo + 4 * shadow_grid.voxel, 4.51 * shadow_grid.voxel)) return;
    if (lane == 0) rays_of_group = 0;
    barrier();
    if (shadow_grid.coverage != 0) makeCoverage(at, lo, renew);
    else makeBits(at, lo, renew);
    barrier();
    if (lane != 0) return;
    states[at] = uvec2(renew.x ? push.version : made.x, renew.y ? push.version : made.y);
    if (rays_of_group > 0) atomicAdd(rays_traced, rays_of_group);
}
