#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Methods `slabs` and `grid`, before the rays of scenes with opaque objects, per eye: which faces pixels read of a
// tile's rays (shared/field.h). One workgroup per tile of 8x8 rays.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8) in;

layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;
layout(constant_id = kIdHasGlass) const bool kHasGlass = false;
const bool kHasOpaque = true;

#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(scalar) buffer Field { float field[]; };

#include "shaders/lib/eye.glsl"
#include "shaders/lib/field_planes.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/casters_met.glsl"
#include "shaders/lib/has_meshes.glsl"
#include "shaders/lib/spread.glsl"

// Cells before and behind a node whose pixels read it (lib/slab_field.glsl).
const int kCellsBefore = 2, kCellsBehind = 2;

// True if the depths of all pixels between `lo` and `hi` lie between those of the four at the corners: only planes are
// seen, and the near plane cuts none.
bool cornersAreExtremes(vec2 lo, vec2 hi) {
    if (kHasMeshes || tick.opaque_count > tick.plane_count) return false;
    const float down = -min(min(rayDirection(lo).y, rayDirection(hi).y),
                            min(rayDirection(vec2(lo.x, hi.y)).y, rayDirection(vec2(hi.x, lo.y)).y));
    for (uint i = 0; i < tick.opaque_count; ++i) {
        const float height = eye.position.y - objects[i].centre.y;
        if (height > 0 && height <= 1.01 * eye.near_depth * down) return false;
    }
    return true;
}

// Bits of view depths: not negative, so that they are ordered as the depths are.
shared uint nearest, furthest;

// Puts the least and the largest view depth of the pixels between `lo` and `hi` there; no more than some, once a depth
// is at least `enough`. Called by all lanes.
void findDepths(ivec2 lo, ivec2 hi, float enough) {
    const int lane = int(gl_LocalInvocationIndex), lanes = int(gl_WorkGroupSize.x);
    const bool corners = cornersAreExtremes(vec2(lo) + 0.5, vec2(hi) + 0.5);
    const ivec2 step = corners ? max(hi - lo - 1, 2) : ivec2(2 * lanes, 2);
    const vec2 texel = 1 / vec2(textureSize(view_depth, 0));
    vec2 range = vec2(kMiss, 0);
    for (int y = lo.y; y <= hi.y && range.y < enough; y += step.y)
        for (int x = lo.x + (corners ? 0 : 2 * lane); x <= hi.x; x += step.x) { // 2x2 pixels
            const vec4 z = textureGather(view_depth, vec2(min(ivec2(x, y), hi - 1) + 1) * texel);
            range.x = min(range.x, min(min(z.x, z.y), min(z.z, z.w)));
            range.y = max(range.y, max(max(z.x, z.y), max(z.z, z.w)));
        }
    if (lane == 0) {
        nearest = floatBitsToUint(range.x);
        furthest = floatBitsToUint(range.y);
    }
    barrier();
    atomicMin(nearest, floatBitsToUint(range.x));
    atomicMax(furthest, floatBitsToUint(range.y));
    barrier();
}

shared uint some_caster; // 1: some caster is found

// Writes which casters' shadows may be met before view depth `far` in the pixels from `lo` to `hi`, and in the blocks
// of pixels that hold them (shafts.comp). Returns whether there are some, or meshes. Called by all lanes.
bool findCasters(uvec2 tile, ivec2 lo, ivec2 hi, float far) {
    const int block = int(kPixelTile) - 1;
    const vec2 first = vec2(lo & ~block), end = vec2((hi | block) + 2); // with the next block's first pixels
    const RayCone cone = rayCone(0.5 * (first + end), 0.5 * length(end - first));
    const vec2 range = mediumBefore(far);
    const uint casters = tick.opaque_count - tick.plane_count;
    if (gl_LocalInvocationIndex == 0) some_caster = 0;
    barrier();
    for (uint word = gl_LocalInvocationIndex; word < grid.caster_words; word += gl_WorkGroupSize.x) {
        uint bits = 0;
        for (uint i = 0; i < min(kWordCasters, casters - kWordCasters * word); ++i)
            if (meetsShadow(tick.plane_count + kWordCasters * word + i, cone, range) < kMiss) bits |= 1u << i;
        field[fieldKept(tile) + kFieldKept + word] = float(bits);
        if (bits != 0) atomicOr(some_caster, 1);
    }
    barrier();
    return kHasMeshes || some_caster != 0;
}

void main() {
    const uvec3 group = spreadGroup();
    enterView(group.z);
    const uvec2 tile = group.xy;
    if (any(greaterThanEqual(tile, grid.lines.xy))) return; // true for the whole workgroup
    const ivec2 first = ivec2(tile * kSlabTile) + ivec2(0, grid.first_row) - int(grid.margin);
    const ivec2 last_pixel = ivec2(eye.size) - 1;
    const ivec2 lo = clamp((first - kCellsBefore) * int(grid.rate), ivec2(0), last_pixel);
    const ivec2 hi = clamp((first + int(kSlabTile) - 1 + kCellsBehind) * int(grid.rate) - 1, ivec2(0), last_pixel);
    // Where objects shadow particles, all before a surface is read. Blocks of pixels may see farther than the tile.
    bool shadowed = kHasCasters && !kHasFog && findCasters(tile, lo, hi, kMiss);
    const ivec2 end = kHasCasters && kHasFog ? min((hi | int(kPixelTile - 1)) + 1, last_pixel) : hi;
    findDepths(lo, end, shadowed ? farDepth() : 2 * kMiss);
    vec2 range = uintBitsToFloat(uvec2(nearest, furthest)); // no ray goes on behind what is seen
    if (kHasCasters && kHasFog) shadowed = findCasters(tile, lo, hi, range.y);
    if (shadowed || kHasGlass) range.x = 0; // layers end at sheets, which may be anywhere before surfaces
    if (kHasLocalLights && tick.particle_count > 0) range.x = min(range.x, grid.depth); // pixels read all of them
    if (gl_LocalInvocationIndex > 0) return;
    const vec2 faces = facesAt(range), below = clamp(floor(faces), vec2(0), vec2(lastFace() - 1));
    const bool before_all = !kHasFog && faces.y <= 0; // True: all surfaces are before the particles
    field[fieldKept(tile)] = max(below.x - 1, 0);
    field[fieldKept(tile) + 1] = before_all ? 0 : min(below.y + 2, lastFace());
    field[fieldKept(tile) + 2] = 0; // the march writes 1
}
