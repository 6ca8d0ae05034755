#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `march`, first pass, per eye: the ray of each marched pixel in steps, whose samples a pattern moves. A lane is
// a pixel.
#include "shaders/shared/constants.h"
#include "shaders/shared/field.h"
#include "shaders/shared/march.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;
layout(constant_id = kIdOneAlbedo) const bool kOneAlbedo = true;
layout(constant_id = kIdJitter) const uint kJitter = kJitterOffset;

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(scalar) readonly buffer Nodes { float nodes[]; };  // written by grid_fill.comp
layout(scalar) writeonly buffer Seen { vec4 seen[]; };    // [row][column]: light, opacity
layout(scalar) writeonly buffer Ends { float ends[]; };   // [row][column]: m of view depth
layout(scalar) readonly buffer Marks { uint marks[]; };   // lib/grid_marks.glsl
layout(scalar) readonly buffer Pattern { float pattern[]; }; // [row][column], in (0, 1)

layout(push_constant, scalar) uniform Push {
    MarchBand band;
    MediumGrid medium;
    vec3 albedo; // of all particles, where they have one
    uint samples;
    uint formula; // 1: the pattern is interleavedNoise(); 0: that of the buffer
} push;

bool hasParticles() { return push.band.particles != 0; }

#include "shaders/lib/grid_marks.glsl"
#include "shaders/lib/medium_nodes.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/eye.glsl"
#include "shaders/lib/march_ray.glsl"
#include "shaders/lib/march_band.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"
#include "shaders/lib/occluded.glsl"
#include "shaders/lib/froxel_light.glsl"
#include "shaders/lib/slice_light.glsl"
#include "shaders/lib/fog_behind.glsl"
#include "shaders/lib/spread.glsl"

const float kNothingSeen = 30; // optical depth behind which nothing is seen
const float kGolden = 0.6180339887498949;

vec3 addedPart(uint i, vec3 x, vec3 away, float distance) { return vec3(arrivingPart(i, x, away, distance)); }
float litPart(uint i, vec3 x, vec3 away) { return isOccluded(x, -away, true) ? 0 : 1; }
float sunlitPart(vec3 x) { return sunlitByMap(x); }

float offsetOf(uvec2 pixel) {
    if (push.formula != 0) return interleavedNoise(float(pixel.x), float(pixel.y));
    const uvec2 at = pixel % kPatternSide;
    return pattern[at.y * kPatternSide + at.x];
}

// The part of the ray between two depths that has medium in it; empty where begin >= end.
void clipToMedium(inout float begin, inout float end) {
    float first = end, last = begin;
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i) {
        const FogPart part = partInFog(i, eye.position, ray_dir, begin, end);
        if (!(part.end > part.begin)) continue;
        first = min(first, part.begin);
        last = max(last, part.end);
    }
    if (hasParticles()) { // the box of their nodes
        const vec3 nodes_wide = vec3(push.medium.bricks * kSlabTile);
        const vec3 inverse = 1 / mix(ray_dir, vec3(1e-12), lessThan(abs(ray_dir), vec3(1e-12)));
        const vec3 lo = push.medium.origin - eye.position, hi = lo + push.medium.spacing * nodes_wide;
        const vec3 a = lo * inverse, b = hi * inverse, near = min(a, b), far = max(a, b);
        const float enter = max(begin, max(near.x, max(near.y, near.z))),
                    leave = min(end, min(far.x, min(far.y, far.z)));
        if (leave > enter) {
            first = min(first, enter);
            last = max(last, leave);
        }
    }
    begin = first;
    end = last;
}

// --- steps of equal opacity: the ray's optical depth is taken as linear within cells.

const uint kCellsOfSample = 4, kLeastCells = 32, kMostCells = 256;

float cells_begin, cell_wide; // m of view depth
uint cell_count, cell;        // how many; the present one
vec2 cell_before, cell_own;   // optical depth before it, and in it: of all, of the particles
float particles_in_step;      // optical depth

vec2 depthOfCell(uint i) {
    const float near = cells_begin + cell_wide * float(i), far = near + cell_wide;
    const float fogs = kHasFog ? fogBetween(eye.position, ray_dir, ray_metres, near, far) : 0;
    vec3 scattering;
    const vec3 middle = eye.position + (near + 0.5 * cell_wide) * ray_dir;
    const float own = hasParticles() ? cell_wide * ray_metres * mediumAt(middle, scattering) : 0;
    return vec2(fogs + own, own);
}

// Starts at the first cell. Returns the optical depth of all.
float startCells(float begin, float end) {
    cell_count = clamp(kCellsOfSample * push.samples, kLeastCells, kMostCells);
    cells_begin = begin;
    cell_wide = (end - begin) / float(cell_count);
    float all = 0;
    [[dont_unroll]] for (uint i = 0; i < cell_count && all < kNothingSeen; ++i) all += depthOfCell(i).x;
    cell = 0;
    cell_before = vec2(0);
    cell_own = depthOfCell(0);
    return all;
}

// The view depth at which an optical depth is reached; not before that of the last call. particles: optical depth of
// the particles before it.
float placeOf(float depth, out float particles) {
    [[dont_unroll]] while (cell + 1 < cell_count && cell_before.x + cell_own.x < depth) {
        cell_before += cell_own;
        ++cell;
        cell_own = depthOfCell(cell);
    }
    const float part = cell_own.x > 0 ? clamp((depth - cell_before.x) / cell_own.x, 0, 1) : 1;
    particles = cell_before.y + part * cell_own.y;
    return cells_begin + cell_wide * (float(cell) + part);
}

vec3 known_albedo = vec3(0); // of the last sample among particles

float particlesIn(float near, float far, out vec3 scattering) {
    if (kJitter != kJitterOpacity) return particlesAtSample(near, far, scattering);
    const float extinction = mediumAt(eye.position + sampledDepth(near, far) * ray_dir, scattering);
    if (extinction > 0) known_albedo = scattering / extinction;
    scattering = particles_in_step * (kOneAlbedo ? push.albedo : known_albedo);
    return particles_in_step;
}

// --- the march

vec3 ray_light = vec3(0);
float ray_passed = 0; // optical depth

void addStep(float near, float far) {
    vec3 scattered = vec3(0);
    float depth;
    addLight(near, far, scattered, depth);
    // The source is even within the step: what it adds is exact then (Hillaire 2015).
    ray_light += scattered * (exp(-ray_passed) * phi(depth));
    ray_passed += depth;
}

void march(float begin, float end, float offset) {
    const float count = float(push.samples);
    float near = begin, particles = 0;
    const float all = kJitter == kJitterOpacity ? startCells(begin, end) : 0, opaque = opacity(all);
    [[dont_unroll]] for (uint i = 0; i < push.samples && ray_passed < kNothingSeen; ++i) {
        const bool last = i + 1 == push.samples;
        float far = last ? end : mix(begin, end, float(i + 1) / count);
        slice_part = kJitter == kJitterStratified ? fract(offset + kGolden * float(i)) : offset;
        if (kJitter == kJitterOpacity) {
            float before, behind;
            const float at = placeOf(min(depthOfOpacity(opaque * ((float(i) + offset) / count)), all), before);
            far = placeOf(last ? all : min(depthOfOpacity(opaque * (float(i + 1) / count)), all), behind);
            if (last) far = end;
            slice_part = far > near ? clamp((at - near) / (far - near), 0, 1) : 0.5;
            angle_part = offset;
            particles_in_step = behind - particles;
            particles = behind;
        }
        if (far > near) addStep(near, far);
        near = max(near, far);
    }
}

void main() {
    const uvec2 at = spreadInvocation().xy;
    if (any(greaterThanEqual(at, push.band.size))) return;
    const uvec2 pixel = marchedPixel(at);
    aimRay(vec2(pixel) + 0.5);
    const float surface = kHasOpaque ? texelFetch(view_depth, ivec2(pixel), 0).r : kEndless;
    const float last = min(surface, push.band.far);
    float begin = push.band.near, end = last;
    clipToMedium(begin, end);
    if (end > begin) march(begin, end, offsetOf(at + uvec2(0, push.band.first_row)));
    if (kHasFog && surface > push.band.far && ray_passed < kNothingSeen)
        ray_light += fogBehind(ray_dir, push.band.far, surface, ray_passed);
    const uint index = at.y * push.band.size.x + at.x;
    seen[index] = vec4(ray_light, opacity(ray_passed));
    ends[index] = last;
}
