#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `froxels`, first pass, per eye: light and optical depth along coarse rays, one sample of all lights in each
// slice (Hillaire, Physically Based and Unified Volumetric Rendering in Frostbite, 2015). A lane is a ray.
#include "shaders/shared/constants.h"
#include "shaders/shared/froxels.h"
#include "shaders/shared/field.h"
#include "shaders/shared/march.h"
#include "shaders/shared/shadow_frustum.h"
#include "shaders/shared/shadow_grid.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;
layout(constant_id = kIdOneAlbedo) const bool kOneAlbedo = true;
layout(constant_id = kIdShadows) const uint kShadows = kShadowsByRay;
layout(constant_id = kIdHistory) const bool kHistory = false;

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Nodes { float nodes[]; }; // written by grid_fill.comp
layout(scalar) writeonly buffer Volume { vec4 volume[]; };
layout(scalar) readonly buffer Furthest { float furthest[]; }; // m, written by furthest_depths.comp
layout(scalar) readonly buffer Marks { uint marks[]; };        // lib/grid_marks.glsl
// The shared shadow grid and the shadow frusta; read with kShadowsByGrid and kShadowsHybrid alone.
layout(scalar) uniform GridBlock { ShadowGridBlock shadow_grid; };
layout(scalar) readonly buffer Voxels { uint shadow_voxels[]; };
layout(scalar) readonly buffer Slots { uint slot_of_light[]; };
layout(scalar) readonly buffer Frusta { ShadowFrustum shadow_frusta[]; };
layout(scalar) readonly buffer FrustumBits { uint shadow_froxels[]; };
// An eye's cells, per m: of this picture and of its last one. Used with kHistory alone.
layout(scalar) buffer Cells { vec4 cells[]; };
layout(scalar) uniform HistoryOfEye { HistoryBlock history; };

layout(push_constant, scalar) uniform Push {
    FroxelGrid froxels;
    MediumGrid medium;
    vec3 albedo; // of all particles, where they have one
    uint view;   // index of the eye's shadow frustum
    uint jitter; // the tick; 0: samples lie in the middle of their slices
} push;

#include "shaders/lib/grid_marks.glsl"
#include "shaders/lib/medium_nodes.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"
#include "shaders/lib/occluded.glsl"
#include "shaders/lib/froxel_march.glsl"
#include "shaders/lib/froxel_light.glsl"
#include "shaders/lib/slice_light.glsl"
#include "shaders/lib/shadow_grid.glsl"
#include "shaders/lib/shadow_frustum.glsl"
#include "shaders/lib/spread.glsl"

float particlesIn(float near, float far, out vec3 scattering) { return particlesAtSample(near, far, scattering); }

// The part of the light of a slot of the shadow grid that objects let through to x. Outside the grid a ray tells.
float litBySlot(uint slot, vec3 x, vec3 toward) {
    if (kShadows == kShadowsHybrid && slot < kMostShadowSlots && ray_slice < shadow_frusta[push.view].slices)
        return litInFrustum(push.view, slot, ray_pixel, ray_slice) ? 1 : 0;
    bool known = false;
    float part = 0;
    if (kShadows == kShadowsByGrid || kShadows == kShadowsHybrid) part = litInGrid(slot, x, known);
    return known ? part : isOccluded(x, toward, true) ? 0 : 1;
}

vec3 addedPart(uint i, vec3 x, vec3 away, float distance) { return vec3(arrivingPart(i, x, away, distance)); }

float litPart(uint i, vec3 x, vec3 away) {
    if (kShadows == kShadowsNone) return 1;
    return litBySlot(kShadows < kShadowsByGrid ? kNoShadowSlot : slot_of_light[i], x, -away);
}

float sunlitPart(vec3 x) {
    if (kShadows == kShadowsNone) return 1;
    if (kShadows == kShadowsByMap) return sunlitByMap(x);
    return litBySlot(shadow_grid.sun, x, kFarAway * tick.sun.to_light);
}

// --- of an eye's last picture

// Where a place lay among that picture's cells: ray, row of rays, slice. False: it was not in the picture.
bool wasAt(vec3 x, out vec3 at) {
    const Eye before = history.eye;
    const vec3 way = x - before.position;
    const float depth = -dot(way, before.back);
    at = vec3(0);
    if (!(depth > history.froxels.near)) return false;
    const vec3 off = way / depth - before.ray;
    const vec2 pixel = vec2(dot(off, before.ray_right) / dot(before.ray_right, before.ray_right),
                            dot(off, before.ray_down) / dot(before.ray_down, before.ray_down));
    const float face = log2(1 + (depth - history.froxels.near) / history.froxels.unit) / history.froxels.growth;
    at = vec3((pixel - 0.5) / float(history.froxels.pixels), face - 0.5);
    const vec3 last = vec3(history.froxels.rays, history.froxels.slices) - 1;
    const bool inside = all(greaterThanEqual(at, vec3(-0.5))) && all(lessThanEqual(at, last + 0.5));
    at = clamp(at, vec3(0), last);
    return inside;
}

uint cellAt(FroxelGrid froxels, uvec3 cell) { return (cell.z * froxels.rays.y + cell.y) * froxels.rays.x + cell.x; }

// Light and optical depth of that picture's cells at a place, per m. False: not known there.
bool wasSeen(vec3 x, out vec4 seen) {
    vec3 at;
    seen = vec4(0);
    if (history.known == 0 || !wasAt(x, at)) return false;
    const uvec3 last = uvec3(history.froxels.rays, history.froxels.slices) - 1, first = min(uvec3(at), last);
    const vec3 part = at - vec3(first);
    [[dont_unroll]] for (uint c = 0; c < 8; ++c) {
        const uvec3 off = uvec3(c & 1, c >> 1 & 1, c >> 2);
        const vec3 share = mix(1 - part, part, vec3(off));
        const vec4 cell = cells[history.first + cellAt(history.froxels, min(first + off, last))];
        if (!(cell.a >= 0)) return false;
        seen += share.x * share.y * share.z * cell;
    }
    return true;
}

void addSlice(float near, float far, inout vec3 scattered, out float depth) {
    addLight(near, far, scattered, depth);
    if (!kHistory) return;
    const float metres = (far - near) * ray_metres;
    const bool has_length = metres > 0;
    vec4 now = has_length ? vec4(scattered, depth) / metres : vec4(0, 0, 0, -1), seen;
    if (has_length && wasSeen(eye.position + faceDepth(float(ray_slice) + 0.5) * ray_dir, seen)) {
        now = mix(now, seen, history.part);
        scattered = now.rgb * metres;
        depth = now.a * metres;
    }
    cells[history.own + cellAt(push.froxels, uvec3(own_ray, ray_slice))] = now;
}

void main() {
    const uvec2 ray = spreadInvocation().xy;
    if (push.jitter != 0) { // a number for each ray and tick
        const vec2 at = vec2(ray) + 5.588238 * float(push.jitter % 64);
        slice_part = interleavedNoise(at.x, at.y);
    }
    march(ray);
    if (!kHistory || any(greaterThanEqual(ray, push.froxels.rays))) return;
    // What lies behind the last slice that was added is not known.
    [[dont_unroll]] for (uint slice = added_slices; slice < push.froxels.slices; ++slice)
        cells[history.own + cellAt(push.froxels, uvec3(ray, slice))] = vec4(0, 0, 0, -1);
}
