// Integrates rays through their slabs from near to far and writes the result into `field` (lib/slab_field.glsl). A
// lane is a ray. Light depth is linear within a slab. Shadows of opaque objects are left to the pixels, since they
// are not band-limited. Include after the tick, the view (lib/view.glsl), `field`, `view_depth`, the images of
// lib/light.glsl, kHasOpaque, kSources, and these functions:
//   startRay(uvec2 tile, uint ray, vec2 pixel)
//   vec4 mediumAt(uint s): extinction (1/m) at the middle of slab s; with several kSources, also scattering in R, G, B
#include "shaders/shared/scatter.h"
#include "shaders/lib/eye.glsl"
#include "shaders/lib/light.glsl"

void march() {
    enterView(gl_WorkGroupID.z);
    if (any(greaterThanEqual(gl_WorkGroupID.xy, grid.lines.xy))) return;
    const uint ray = gl_LocalInvocationIndex;
    const uvec2 node = gl_WorkGroupID.xy * kSlabTile + uvec2(ray % kSlabTile, ray / kSlabTile);
    const uint plane = grid.nodes.x * grid.nodes.y, mine = field_at + node.y * grid.nodes.x + node.x;
    const uint set = kHasOpaque ? (grid.slabs + 2) * plane : plane;
    const bool inside = all(lessThan(node, grid.nodes));
    const vec2 at = (vec2(node) + vec2(0, grid.first_row) - float(grid.margin)) * float(grid.rate) + 0.5;
    const float ray_length = length(rayDirection(at)); // m per m of view depth
    const vec3 volume_dir = map_rays.ray + at.x * map_rays.right + at.y * map_rays.down;
    float depth = 0, light = 0, scattered[kSources];
    for (uint c = 0; c < kSources; ++c) scattered[c] = 0;
    if (kHasOpaque && inside)
        for (uint c = 0; c <= kSources; ++c) field[c * set + mine] = 0;
    bool known = false; // True: the light depth at the slab's near face is known
    startRay(gl_WorkGroupID.xy, ray, at);
    // Values at the middles of the previous slab, this one and the next two.
    float before;
    vec4 here = vec4(0), next = vec4(0), then = vec4(0);
    for (uint ahead = 0; ahead < grid.slabs + 2; ++ahead) {
        before = here.x;
        here = next;
        next = then;
        then = ahead < grid.slabs ? mediumAt(ahead) : vec4(0);
        if (ahead < 2) continue;
        const uint s = ahead - 2;
        if (s == 0) before = 3 * here.x - 3 * next.x + then.x; // the first slab curves as the second
        // Integral over the slab of the parabola through three middles: one sample alone would err where the near
        // plane or a wall cuts the medium.
        const float slab = max(here.x + (before - 2 * here.x + next.x) / 24, 0) * (ray_length * slabThickness(s));
        if (slab > 0) {
            const float face = faceDepth(s);
            if (!known) light = lightDepth(map_rays.eye + face * volume_dir);
            const float light_behind = lightDepth(map_rays.eye + (face + slabThickness(s)) * volume_dir);
            const float gain = exp(-depth) * scatterAnalytic(slab, light, light_behind);
            if (kSources == 1) {
                scattered[0] += gain;
            } else {
                for (uint c = 0; c < kSources; ++c) {
                    const float albedo = here.x > 0 ? min(here[c % 3 + 1] / here.x, 1) : 0;
                    scattered[c] += albedo * (c < 3 ? gain : exp(-depth) * opacity(slab));
                }
            }
            depth += slab;
            light = light_behind;
        }
        known = slab > 0;
        if (kHasOpaque && inside) {
            field[(s + 1) * plane + mine] = depth;
            for (uint c = 0; c < kSources; ++c) field[(c + 1) * set + (s + 1) * plane + mine] = scattered[c];
        }
    }
    if (!inside) return;
    uint whole = mine;
    if (kHasOpaque) { // up to what the ray hits
        const float z = texelFetch(view_depth, ivec2(clamp(at, vec2(0), vec2(eye.size) - 1)), 0).r;
        const float end = clamp(faceAt(z), 0, float(grid.slabs));
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
