#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_arithmetic : require
// Method `slabs`, third pass, per eye: traces rays through the slabs that slabs.comp has filled.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 64)  in; // kSlabTile * kSlabTile

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;
layout(constant_id = kIdScattering) const uint kScatteringModel = 0;
layout(constant_id = kIdHasLobe) const bool kHasLobe = true;

layout(scalar) readonly buffer Added { float added[]; }; // written by slabs.comp
layout(scalar) buffer Field { float field[]; };          // shared/field.h

#include "shaders/lib/field_planes.glsl"

uint tile_from;   // in `added`: index of the first slab of the tile's first ray
uint from, apart; // index of the ray's first slab; distance between quantities
bool empty;       // True: the sheet has no members

// True if no particle reaches the sheet of slab `s`.
bool isEmpty(uint s) { return added[tile_from + s * gl_WorkGroupSize.x] < 0; }

uvec2 startRay(uvec3 tile, uint ray, vec2 pixel) {
    const uint tiles = grid.lines.x * grid.lines.y, rays = gl_WorkGroupSize.x;
    tile_from = views[tile.z].added * 4 + (tile.y * grid.lines.x + tile.x) * grid.slabs * rays;
    from = tile_from + ray;
    apart = tiles * grid.slabs * rays;
    empty = true;
    // Each lane asks other sheets. The first and the last one with medium are those of all lanes.
    uint first = grid.slabs, end = 0;
    for (uint s = gl_SubgroupInvocationID * grid.sheet; s < grid.slabs; s += gl_SubgroupSize * grid.sheet)
        if (!isEmpty(s)) {
            first = min(first, s);
            end = s + grid.sheet;
        }
    first = subgroupMin(first);
    end = subgroupMax(end);
    return end == 0 ? uvec2(grid.slabs) : uvec2(max(first, 1) - 1, min(end + 1, grid.slabs));
}

vec4 mediumAt(uint s) {
    const uint at = from + s * gl_WorkGroupSize.x;
    if ((s & (grid.sheet - 1)) == 0) empty = isEmpty(s);
    vec4 medium = vec4(0);
    if (empty) return medium;
    for (uint q = 0; q < mediumQuantities(kSunColours == 1); ++q) medium[q] = added[at + q * apart];
    return medium;
}

#include "shaders/lib/slab_march.glsl"

void main() { march(); }
