#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Slabs, third pass: a lane is a ray and goes through its slabs from near to far, the light depth linear within each. Shadows of
// opaque objects are not band-limited: they are left to the pixels.
#include "shaders/shared/types.h"
#include "shaders/shared/scatter.h"

layout(local_size_x = 64) in; // kSlabTile * kSlabTile

layout(constant_id = 0) const bool kHasOpaque = true;
layout(constant_id = 24) const uint kSources = 1; // as in lib/slab_field.glsl

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) uniform EyeBlock { Eye eye; };
layout(scalar, binding = 2) readonly buffer Added { float added[]; }; // as in slabs.comp
layout(scalar, binding = 3) buffer Field { float field[]; };          // as in lib/slab_field.glsl
layout(binding = 6) uniform sampler2DArray shadow_volume;
layout(binding = 7) uniform sampler2D opaque_shadow;
layout(binding = 8) uniform sampler2D view_depth;

layout(push_constant, scalar) uniform Push { SlabGrid grid; } push;

#include "shaders/lib/eye.glsl"
#include "shaders/lib/light.glsl"

void main() {
    const SlabGrid grid = push.grid;
    const uint ray = gl_LocalInvocationIndex, rays = gl_WorkGroupSize.x;
    const uvec2 node = gl_WorkGroupID.xy * kSlabTile + uvec2(ray % kSlabTile, ray / kSlabTile);
    const uint tile = gl_WorkGroupID.y * grid.lines.x + gl_WorkGroupID.x;
    const uint from = tile * grid.slabs * rays + ray; // in `added`, and as far apart are what lies there:
    const uint apart = grid.lines.x * grid.lines.y * grid.slabs * rays;
    const uint plane = grid.nodes.x * grid.nodes.y, mine = node.y * grid.nodes.x + node.x;
    const uint set = kHasOpaque ? (grid.slabs + 2) * plane : plane;
    const bool inside = all(lessThan(node, grid.nodes));
    const vec2 at = (vec2(node) + vec2(0, grid.first_row) - float(grid.margin)) * float(grid.rate) + 0.5;
    const float length_of_slab = length(rayDirection(at)) * grid.thickness;
    const vec3 volume_dir = eye.volume_ray + at.x * eye.volume_right + at.y * eye.volume_down;
    float depth = 0, light = 0, scattered[kSources];
    for (uint c = 0; c < kSources; ++c) scattered[c] = 0;
    if (kHasOpaque && inside)
        for (uint c = 0; c <= kSources; ++c) field[c * set + mine] = 0;
    bool known = false; // the light depth at the slab's near face
    // Extinction at the middles of the slab before, this one and the next; the first slab curves as the second.
    float here = added[from], next = added[from + rays], before = 3 * here - 3 * next + added[from + 2 * rays];
    for (uint s = 0; s < grid.slabs; ++s) {
        // Integral over the slab of the parabola through three middles: one sample alone would err where the near plane or a wall
        // cuts the medium.
        const float slab = max(here + (before - 2 * here + next) / 24, 0) * length_of_slab;
        if (slab > 0) {
            const float face = grid.depth + float(s) * grid.thickness;
            if (!known) light = lightDepth(eye.volume + face * volume_dir);
            const float light_behind = lightDepth(eye.volume + (face + grid.thickness) * volume_dir);
            const float gain = exp(-depth) * scatterAnalytic(slab, light, light_behind);
            if (kSources == 1) {
                scattered[0] += gain;
            } else {
                for (uint c = 0; c < kSources; ++c) {
                    const float albedo = here > 0 ? min(added[(c % 3 + 1) * apart + from + s * rays] / here, 1) : 0;
                    scattered[c] += albedo * (c < 3 ? gain : exp(-depth) * opacity(slab));
                }
            }
            depth += slab;
            light = light_behind;
        }
        known = slab > 0;
        before = here;
        here = next;
        next = s + 2 < grid.slabs ? added[from + (s + 2) * rays] : 0;
        if (kHasOpaque && inside) {
            field[(s + 1) * plane + mine] = depth;
            for (uint c = 0; c < kSources; ++c) field[(c + 1) * set + (s + 1) * plane + mine] = scattered[c];
        }
    }
    if (!inside) return;
    uint whole = mine;
    if (kHasOpaque) { // up to what the ray hits
        const float z = texelFetch(view_depth, ivec2(clamp(at, vec2(0), vec2(eye.size) - 1)), 0).r;
        const float end = clamp((z - grid.depth) / grid.thickness, 0, float(grid.slabs));
        const float face = min(floor(end), float(grid.slabs - 1));
        const uint below = uint(face) * plane + mine;
        depth = mix(field[below], field[below + plane], end - face);
        for (uint c = 0; c < kSources; ++c)
            scattered[c] = mix(field[(c + 1) * set + below], field[(c + 1) * set + below + plane], end - face);
        field[(kSources + 1) * set + mine] = end;
        whole += (grid.slabs + 1) * plane;
    }
    field[whole] = depth;
    for (uint c = 0; c < kSources; ++c) field[(c + 1) * set + whole] = scattered[c] / max(opacity(depth), 1e-30);
}
