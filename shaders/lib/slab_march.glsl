// Integrates rays through their slabs from near to far and writes the result into `field` (shared/field.h). A
// lane is a ray. Within a slab extinction varies linearly and light depth as a parabola (scatterVaried). Shadows of
// opaque objects are left to the pixels, since they are not band-limited. Include after the tick, the view
// (lib/view.glsl), `field`, `view_depth`, the images of lib/light.glsl, lib/field_planes.glsl, and these functions:
//   uvec2 startRay(uvec2 tile, uint ray, vec2 pixel): the ray's slabs s with .x <= s < .y, all that have medium and
//     those beside them
//   vec4 mediumAt(uint s): the medium's quantities (shared/field.h) at the middle of slab s; asked in this order,
//     and slab 3 with slab 2, too
#include "shaders/shared/scatter.h"
#include "shaders/lib/eye.glsl"
#include "shaders/lib/light.glsl"

// The value before the first four of a row, as they go on: by a cubic where they are smooth, by a parabola where the
// cubic's term is large. The near plane cuts particles anywhere, and the first slab has no neighbour in front.
float beforeFirst(vec4 first) {
    const float parabola = 3 * (first.x - first.y) + first.z, cubic = first.x - first.w + 3 * (first.z - first.y);
    const float sum = first.x + first.y + first.z + first.w;
    return parabola + cubic * (sum * sum) / max(sum * sum + 64 * cubic * cubic, 1e-37);
}

// Optical depth between the light and a point of a ray; finite, so that differences are numbers.
float lightAt(vec3 volume_dir, float depth) { return min(lightDepth(map_rays.eye + depth * volume_dir), 1e18); }

// Writes the quantities of a ray at faces `first` to `last`.
void writeFaces(uint first, uint last, uint node, float sum[kMostFieldQuantities]) {
    for (uint face = first; face <= last; ++face)
        for (uint q = 0; q < fieldQuantities(); ++q) field[fieldFace(q, face) + node] = sum[q];
}

void march() {
    enterView(gl_WorkGroupID.z);
    if (any(greaterThanEqual(gl_WorkGroupID.xy, grid.lines.xy))) return;
    const uint ray = gl_LocalInvocationIndex;
    const uvec2 node = gl_WorkGroupID.xy * kSlabTile + uvec2(ray % kSlabTile, ray / kSlabTile);
    const uint mine = node.y * grid.nodes.x + node.x, quantities = fieldQuantities();
    const bool inside = all(lessThan(node, grid.nodes));
    const vec2 at = (vec2(node) + vec2(0, grid.first_row) - float(grid.margin)) * float(grid.rate) + 0.5;
    const float ray_length = length(rayDirection(at)); // m per m of view depth
    const vec3 volume_dir = map_rays.ray + at.x * map_rays.right + at.y * map_rays.down;
    float sum[kMostFieldQuantities]; // the field's quantities up to here
    vec4 light = vec4(0);            // light depth at the face before the slab's near one, its own two, the next one
    for (uint q = 0; q < quantities; ++q) sum[q] = 0;
    uint first_face = 1, last_face = grid.slabs; // those that are written; the march ends at the last
    if (kHasOpaque) {
        const uint kept = fieldKept(gl_WorkGroupID.xy);
        first_face = uint(field[kept]);
        last_face = uint(field[kept + 1]);
    }
    const uvec2 slabs = min(startRay(gl_WorkGroupID.xy, ray, at), uvec2(last_face));
    if (kHasOpaque && inside) writeFaces(first_face, slabs.x, mine, sum);
    bool known = false; // True: the light depth at the slab's own faces is known
    // Extinction at the middle of the previous slab, the medium at the middles of this one and the next two.
    float before;
    vec4 here = vec4(0), next = vec4(0), then = vec4(0);
    for (uint ahead = slabs.x; ahead < slabs.y + 2; ++ahead) {
        before = here[kExtinction];
        here = next;
        next = then;
        then = ahead < grid.slabs ? mediumAt(ahead) : vec4(0);
        if (ahead < slabs.x + 2) continue;
        const uint s = ahead - 2;
        // Beyond the ends of a row, as it goes on. Logarithms of Gaussians are concave, which bounds that.
        const float square = here[kExtinction] * here[kExtinction];
        if (s == 0) {
            before = beforeFirst(
                vec4(here[kExtinction], next[kExtinction], then[kExtinction], mediumAt(3)[kExtinction]));
            before = clamp(before, 0, square / max(next[kExtinction], 1e-30));
        }
        if (s + 1 == grid.slabs)
            next[kExtinction] = clamp(2 * here[kExtinction] - before, 0, square / max(before, 1e-30));
        // Integral over the slab of the parabola through three middles: one sample alone would err where the near
        // plane or a wall cuts the medium.
        const float curvature = before - 2 * here[kExtinction] + next[kExtinction];
        const float slab = max(here[kExtinction] + curvature / 24, 0) * (ray_length * slabThickness(s));
        if (slab > 0) {
            const float face = faceDepth(s), thick = slabThickness(s);
            if (!known) {
                light.y = lightAt(volume_dir, face);
                light.z = lightAt(volume_dir, face + thick);
                light.x = lightAt(volume_dir, face - thick);
            }
            light.w = lightAt(volume_dir, face + 2 * thick);
            const float mean = here[kExtinction] + curvature / 24;
            const float slope = clamp(0.5 * (next[kExtinction] - before) / mean, -2, 2);
            const float bend = 0.5 * (light.w - light.z - light.y + light.x);
            const float transmittance = exp(-sum[kFieldDepth]);
            const float sun = transmittance * scatterAnalytic(slab, light.y, light.z) *
                              scatterVaried(slab, light.y, light.z, slope, bend);
            if (kSunColours == 1) {
                sum[kFieldSun] += sun;
            } else {
                const float ambient = transmittance * opacity(slab);
                for (uint c = 0; c < 3; ++c) {
                    const float albedo =
                        here[kExtinction] > 0 ? min(here[kScattering + c] / here[kExtinction], 1) : 0;
                    sum[kFieldSun + c] += albedo * sun;
                    if (kAmbientColours > 0) sum[fieldAmbient() + c] += albedo * ambient;
                }
            }
            sum[kFieldDepth] += slab;
            light.xyz = light.yzw;
        }
        known = slab > 0;
        if (kHasOpaque && inside && s + 1 >= first_face) writeFaces(s + 1, s + 1, mine, sum);
    }
    if (!inside) return;
    if (kHasOpaque) { // up to what the ray hits
        writeFaces(max(first_face, slabs.y + 1), last_face, mine, sum);
        if (sum[kFieldDepth] > 0) field[fieldKept(gl_WorkGroupID.xy) + 2] = 1;
        const float z = texelFetch(view_depth, ivec2(clamp(at, vec2(0), vec2(eye.size) - 1)), 0).r;
        const float end = clamp(faceAt(z), 0, float(grid.slabs));
        const float face = min(floor(end), float(grid.slabs - 1));
        for (uint q = 0; q < quantities; ++q) {
            vec4 values;
            for (uint i = 0; i < 4; ++i) values[i] = field[fieldFace(q, facesAround(uint(face))[i]) + mine];
            sum[q] = betweenFaces(values, end - face);
        }
        field[fieldEnd() + mine] = end;
    }
    field[fieldWhole(kFieldDepth) + mine] = sum[kFieldDepth];
    const float opaque_part = max(opacity(sum[kFieldDepth]), 1e-30);
    for (uint q = kFieldSun; q < quantities; ++q) field[fieldWhole(q) + mine] = sum[q] / opaque_part;
}
