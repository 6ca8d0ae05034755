// Integrates rays through their slabs from near to far and writes the result into `field` (shared/field.h). A
// lane is a ray. Within a slab the particles' extinction varies linearly and light depth as a parabola (scatterVaried);
// fog adds its own light (lib/fog_march.glsl). Shadows of opaque objects are left to the pixels, since they are not
// band-limited. Include after lib/view.glsl, `field`,
// lib/field_planes.glsl, and these functions:
//   uvec2 startRay(uvec3 tile, uint ray, vec2 pixel): the ray's slabs s with .x <= s < .y, all that have medium and
//     those beside them; the tile's number across, down, and that of its view
//   vec4 mediumAt(uint s): the medium's quantities (shared/field.h) at the middle of slab s; asked in this order,
//     and slab 3 with slab 2, too
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/emission.h"
#include "shaders/shared/scatter.h"
#include "shaders/lib/eye.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/fog_march.glsl"
#include "shaders/lib/medium_phase.glsl"
#include "shaders/lib/lamps_on_rays.glsl"
#include "shaders/lib/multiple.glsl"
#include "shaders/lib/spread.glsl"
#include "shaders/lib/layer_cuts.glsl"

// The value before the first four of a row, as they go on: by a cubic where they are smooth, by a parabola where the
// cubic's term is large. The near plane cuts particles anywhere, and the first slab has no neighbour in front.
float beforeFirst(vec4 first) {
    const float parabola = 3 * (first.x - first.y) + first.z, cubic = first.x - first.w + 3 * (first.z - first.y);
    const float sum = first.x + first.y + first.z + first.w;
    return parabola + cubic * (sum * sum) / max(sum * sum + 64 * cubic * cubic, 1e-37);
}

// A slab with less optical depth is taken as empty, as a part of what one particle may leave out. 512 slabs leave out
// half of that.
const float kLeastSlab = 1e-3;

// The medium's quantities at the middle of slab s, in the channels that are drawn.
vec4 drawnMedium(uint s) { return tick.extinction * mediumAt(s); }

// What a ray's particles hide up to the face `end`: a part of 1.
float hiddenBefore(uvec2 slabs, float end) {
    float depth = 0;
    for (uint face = slabs.x; face < slabs.y && float(face) < end; ++face) {
        const uint s = face - frontSlabs();
        if (s < grid.slabs) depth += drawnMedium(s)[kExtinction];
    }
    return opacity(depth * march_length * slabThickness());
}

// Writes the quantities of a ray at faces `first` to `last`.
void writeFaces(uint first, uint last, uint node, float sum[kMostFieldQuantities]) {
    for (uint face = first; face <= last; ++face)
        for (uint q = 0; q < fieldQuantities(); ++q)
            if (isHeld(q)) field[fieldFace(q, face) + node] = sum[q];
}

void march() {
    const uvec3 group = spreadGroup();
    const uvec2 tile = group.xy;
    enterView(group.z);
    if (any(greaterThanEqual(tile, grid.lines.xy))) return;
    const uint ray = gl_LocalInvocationIndex;
    const uvec2 node = tile * kSlabTile + uvec2(ray % kSlabTile, ray / kSlabTile);
    const uint mine = node.y * grid.nodes.x + node.x, quantities = fieldQuantities();
    const bool inside = all(lessThan(node, grid.nodes));
    const vec2 at = (vec2(node) + vec2(0, grid.first_row) - float(grid.margin)) * float(grid.rate) + 0.5;
    march_dir = rayDirection(at);
    march_length = length(march_dir);
    march_volume = map_rays.ray + at.x * map_rays.right + at.y * map_rays.down;
    startMultiple(march_dir / march_length);
    float sum[kMostFieldQuantities]; // the field's quantities up to here
    vec4 light = vec4(0);            // light depth at the face before the slab's near one, its own two, the next one
    for (uint q = 0; q < quantities; ++q) sum[q] = 0;
    uint first_face = 1, last_face = lastFace(); // those that are written; the march ends at the last
    if (kHasOpaque) {
        const uint kept = fieldKept(tile);
        first_face = uint(field[kept]);
        last_face = uint(field[kept + 1]);
    }
    uvec2 slabs = startRay(group, ray, at);
    if (areLampsHeld()) { // lanes work together in each slab
        const uint end = subgroupMax(slabs.x < slabs.y ? slabs.y : 0);
        slabs = end == 0 ? uvec2(grid.slabs) : uvec2(subgroupMin(slabs.x), end);
    }
    slabs = kHasFog ? uvec2(0, last_face) : min(slabs, uvec2(last_face));
    if (kHasOpaque && inside) writeFaces(first_face, slabs.x, mine, sum);
    if (kHasFog) startFog(kHasOpaque ? surfaceDepth(at) : kEndless);
    uint layered_end = 0; // face behind the last slab in front of the surface, of a ray that is cut into layers
    if (kDepthLayers) {
        const uvec2 numbered = node + uvec2(0, grid.first_row);
        is_layered = inside && isLayerNode(numbered);
        if (is_layered) {
            const float end = kHasOpaque ? clamp(faceAt(surfaceDepth(at)), 0, float(lastFace())) : float(lastFace());
            layered_end = uint(end);
            startLayers(numbered, hiddenBefore(slabs, end));
        }
        startRay(group, ray, at); // slabs are asked for in order again
    }
    const float least = kLeastSlab * tick.cut;
    bool known = false; // True: the light depth at the slab's own faces is known
    // Extinction at the middle of the previous slab, the medium at the middles of this one and the next two.
    float before;
    vec4 here = vec4(0), next = vec4(0), then = vec4(0);
    const uint bin = binOf(uvec2(clamp(at, vec2(0), vec2(eye.size) - 1)));
    float seen = 0; // optical depth of particles up to the first face behind all surfaces of the tile: the last but one
    const bool goes_on = kHasFog && last_face == lastFace(); // True: there is fog behind the last face, too
    for (uint ahead = slabs.x; ahead < slabs.y + kSlabsAhead + (goes_on ? 1 : 0); ++ahead) {
        before = here[kExtinction];
        here = next;
        next = then;
        then = ahead - frontSlabs() < grid.slabs ? drawnMedium(ahead - frontSlabs()) : vec4(0);
        if (ahead < slabs.x + kSlabsAhead) continue;
        const uint face = ahead - kSlabsAhead, s = face - frontSlabs(); // the slab and its near face
        float slab = 0, slope = 0;
        if (before + here[kExtinction] + next[kExtinction] > 0 && !isFogAlone(face)) {
            // Beyond the ends of a row, as it goes on. Logarithms of Gaussians are concave, which bounds that.
            const float square = here[kExtinction] * here[kExtinction];
            if (s == 0) {
                before = beforeFirst(
                    vec4(here[kExtinction], next[kExtinction], then[kExtinction], drawnMedium(3)[kExtinction]));
                before = clamp(before, 0, square / max(next[kExtinction], 1e-30));
            }
            if (s + 1 == grid.slabs)
                next[kExtinction] = clamp(2 * here[kExtinction] - before, 0, square / max(before, 1e-30));
            // Integral over the slab of the parabola through three middles: one sample alone would err where the near
            // plane or a wall cuts the medium.
            const float curvature = before - 2 * here[kExtinction] + next[kExtinction];
            const float mean = here[kExtinction] + curvature / 24;
            slab = max(mean, 0) * (march_length * slabThickness());
            slope = clamp(0.5 * (next[kExtinction] - before) / mean, -2, 2);
            if (slab <= least) slab = 0;
        }
        if (slab > 0) {
            const float near = faceDepth(face), thick = slabThickness();
            [[dont_unroll]] for (int next_face = known ? 2 : -1; next_face < 3; ++next_face)
                light = vec4(light.yzw, lightAt(near + float(next_face) * thick));
        }
        // Of a lone fog, slabs without particles are summed together, up to one with particles or a face that is
        // written.
        const bool waits = isLoneFog() && !(slab > 0) && face < last_face && (!kHasOpaque || face + 1 < first_face);
        if (kHasFog && !waits) passFog(sum, face, slab, light.z);
        vec3 lamps = vec3(0);
        if (areLampsHeld() && subgroupAny(slab > 0))
            lamps = lampsOfSlab(bin, march_dir, march_length, faceDepth(face), faceDepth(face + 1), slab, slope);
        if (slab > 0) {
            if (kDepthLayers && is_layered) enterLayerSlab(sum);
            const float all = slab + (kHasFog ? fog_own : 0);
            const float bend = 0.5 * (light.w - light.z - light.y + light.x);
            const float transmittance = exp(-sum[kFieldDepth] - (kHasFog ? fog_passed : 0));
            const float even = kHasFog ? scatterOwn(slab, light.y, all + light.z) :
                                         scatterAnalytic(slab, light.y, light.z);
            const float sun = transmittance * even * scatterVaried(all, light.y, light.z, slope, bend);
            const float ambient = transmittance * (kHasFog ? scatterOwn(slab, 0, all) : opacity(slab));
            vec3 multiple = vec3(0), with_multiple = vec3(sun);
            if (kScatteringModel != kScatteringSingle) {
                const float middle = faceDepth(face) + 0.5 * slabThickness();
                vec3 straight;
                multiple = transmittance * multipleOfSlab(max(kMultipleColours, kSunColours),
                                                          map_rays.eye + middle * march_volume, slab, light.y, light.z,
                                                          straight);
                // Of one albedo that has a colour the sun's quantity holds what all channels have.
                const bool has_colour = kSunColours == 1 && kMultipleColours == 3;
                const vec3 alike = has_colour ? vec3(min(straight.x, min(straight.y, straight.z))) : straight;
                with_multiple += transmittance * alike;
                if (has_colour) multiple += transmittance * sun_phase * tick.multiple.sun * (straight - alike);
                if (kMultipleColours == 0) with_multiple += multiple / max(sun_phase, 1e-6);
            }
            if (kMultipleColours == 1) sum[fieldMultiple()] += multiple.x;
            if (kSunColours == 1) sum[kFieldSun] += with_multiple.x;
            vec3 albedos = grid.albedo;
            if (kSunColours == 3) {
                const vec3 scattering = vec3(here[kScattering], here[kScattering + 1], here[kScattering + 2]);
                albedos = here[kExtinction] > 0 ? min(scattering / here[kExtinction], 1) : vec3(0);
            }
            vec3 glow = vec3(0);
            if (kHasEmission && holdsGlow()) glow = emitted(tick.emission, tick.cold_albedo, 1, albedos);
            for (uint c = 0; c < 3; ++c) {
                const float albedo = albedos[c];
                if (kSunColours == 3) sum[kFieldSun + c] += albedo * with_multiple[c];
                if (kAmbientColours > 0) sum[fieldAmbient() + c] += albedo * ambient;
                if (kHasEmission && holdsGlow()) sum[fieldGlow() + c] += glow[c] * ambient;
                if (kLampsOnRays) sum[fieldLamps() + c] += albedo * transmittance * lamps[c];
                if (kMultipleColours == 3) sum[fieldMultiple() + c] += albedo * multiple[c];
                if (kHasLocalLights && kSunColours == 3) sum[fieldScattering() + c] += albedo * slab;
            }
            sum[kFieldDepth] += slab;
            if (kDepthLayers && is_layered && face < layered_end)
                passLayerSlab(sum, faceDepth(face) + 0.5 * slabThickness(), slabThickness());
        }
        known = slab > 0;
        if (face + 1 < last_face || last_face == lastFace()) seen = sum[kFieldDepth];
        if (kHasOpaque && inside && face + 1 >= first_face && face < last_face)
            writeFaces(face + 1, face + 1, mine, sum);
    }
    if (!inside) return;
    if (kHasOpaque) { // up to what the ray hits
        writeFaces(max(first_face, slabs.y + 1), max(last_face, 2), mine, sum); // the first three are always read
        if (seen > 0) field[fieldKept(tile) + 2] = 1;
        const float end = clamp(faceAt(surfaceDepth(at)), 0, float(lastFace()));
        const float face = min(floor(end), float(lastFace() - 1));
        for (uint q = 0; q < quantities; ++q) {
            if (!isHeld(q)) continue;
            if (kHasFog && fog_ended) {
                sum[q] = at_end[q];
                continue;
            }
            vec4 values;
            for (uint i = 0; i < 4; ++i) values[i] = field[fieldFace(q, facesAround(uint(face))[i]) + mine];
            sum[q] = betweenFaces(values, end - face, uint(face));
        }
        field[fieldEnd() + mine] = end;
    }
    if (kDepthLayers && is_layered) endLayers(sum, faceDepth(layered_end));
    field[fieldWhole(kFieldDepth) + mine] = sum[kFieldDepth];
    if (kHasFog) {
        float scale[kMostFieldQuantities];
        fieldScale(march_dir, surface, sum[kFieldDepth], scale);
        for (uint q = kFieldSun; q < quantities; ++q)
            field[fieldWhole(q) + mine] = scale[q] > kLeastScale ? sum[q] / scale[q] : -1;
        return;
    }
    const float opaque_part = max(opacity(sum[kFieldDepth]), 1e-30);
    for (uint q = kFieldSun; q < quantities; ++q)
        if (isHeld(q)) field[fieldWhole(q) + mine] = sum[q] / opaque_part;
}
