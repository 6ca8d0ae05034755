// The light of points and spots that the medium scatters along a pixel's ray. Each light's part of the ray is cut where
// objects hide the light, where fogs begin and end, and at the particles' slabs. Each piece is integrated over the
// angle that the light sees (shared/equiangular.h). Include after lib/slab_field.glsl, lib/fog.glsl, lib/objects.glsl,
// lib/local_lights.glsl, lib/local_light_depth.glsl and lib/point_shadow.glsl.
#include "shaders/blocks/light_bits.glsl"
#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/meshes.glsl"
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/is_on_rays.glsl"
#include "shaders/shared/equiangular.h"
#include "shaders/shared/lamps.h"
#include "shaders/shared/phase.h"
#include "shaders/shared/slab_growth.h"

const uint kMostSlabs = 512;
// The largest panels of four nodes; docs/models.md has the errors.
const float kMostAngle = 1.3; // rad
const float kMostDepth = 2;   // optical depth
// Breaks on both sides of the place closest to the light: as parts of the half chord in the range, and of the length in
// which the fog's light fades. Far from the light the angle hardly changes any more, but window and fog do.
const float kRangeBreak = 0.4;
const vec2 kFogBreaks = vec2(1, 3);
const uint kMostPanels = 8; // that a piece is divided into
// Pieces of two nodes and of one: shorter than this part of their distance from the light, and as thin.
const float kShort = 0.4, kTiny = 0.1;
const float kMostGrowth = 2; // of extinction in a slab, where two nodes do
const float kCore = 12;      // pixels around a light's image in which its glow is no polynomial
const float kThin = 6;       // pixels, half the width of cones and the falloff of layers that fall between nodes
const uint kMostPieces = 700; // that a ray's part in one light is divided into
const float kNoDepth = 1e-9;  // optical depth of a slab below which it counts as empty

// Near lights of the workgroup's tile: those of which its nodes may miss something. A bit each, and 1 if there is one.
shared uint near_lights[kMostLocalLights / 32];
shared uint any_is_near;

// The pixel's ray: places in m from the eye.
vec3 ray_dir; // unit
float ray_end;
FogPart fog_parts[kMostFogs];
float particle_begin, slab_length; // where the first slab begins, and the length of each
uint slabs_before;                 // the number of slabs that the ray enters
float depth_to[kMostSlabs + 2];    // optical depth of the particles before each face, and one behind the last entered
float depth_log[kMostSlabs + 1];   // slabLog() of each slab

// Fills what belongs to particles, as the pixel's neighbours among the rays have it.
void readParticles(ivec2 pixel, float metres) {
    particle_begin = grid.depth * metres;
    slab_length = grid.thickness * metres;
    slabs_before = 0;
    if (tick.particle_count == 0) return;
    const float passed = ceil((ray_end - particle_begin) / slab_length);
    slabs_before = uint(clamp(passed, 0, float(grid.slabs)));
    if (slabs_before == 0) return;
    const FieldRun run = fieldRun(pixel);
    const vec4 down = through(run.down), across = kRate == 1 ? vec4(1, 0, 0, 0) : through(fieldPart(pixel.x));
    depth_to[0] = 0;
    [[dont_unroll]] for (uint face = 1; face <= min(slabs_before + 1, grid.slabs); ++face) {
        const float value = dot(across, fieldColumns(fieldFace(kFieldDepth, frontSlabs() + face), run, down));
        depth_to[face] = max(value, depth_to[face - 1]);
        depth_log[face - 1] = slabLog(depth_to[face] - depth_to[face - 1]);
    }
}

// Albedo of the particles in a slab.
vec3 albedoOf(uint slab, ivec2 pixel) {
    if (kSunColours == 1) return grid.albedo;
    const FieldRun run = fieldRun(pixel);
    const vec4 down = through(run.down), across = kRate == 1 ? vec4(1, 0, 0, 0) : through(fieldPart(pixel.x));
    vec3 scattering;
    [[dont_unroll]] for (uint c = 0; c < 3; ++c) {
        const uint q = fieldScattering() + c, face = frontSlabs() + slab;
        scattering[c] = dot(across, fieldColumns(fieldFace(q, face + 1), run, down) -
                                        fieldColumns(fieldFace(q, face), run, down));
    }
    return clamp(scattering / max(depth_to[slab + 1] - depth_to[slab], 1e-20), 0, 1);
}

// How extinction grows within a slab. What lies before the first and behind the last one is not known.
GrownSlab growthOf(uint slab) {
    const float unknown = slabLog(0), before = slab > 0 ? depth_log[slab - 1] : unknown;
    return grownSlab(before, depth_log[slab], slab + 1 < grid.slabs ? depth_log[slab + 1] : unknown);
}

float phaseAt(Phase p, vec3 away) {
    return phaseOfLobes(away, -ray_dir, p.part, p.asymmetry, p.draine, p.second);
}

// Optical depth of fogs before a place of the ray.
float fogTo(float place) {
    float sum = 0;
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i)
        sum += depthInFog(i, eye.position, ray_dir, 1, FogPart(fog_parts[i].begin, min(fog_parts[i].end, place)));
    return sum;
}

// Length in which the light that fog scatters at a place of the ray fades: by the extinction, on its way from the light
// and to the eye, and by the fog's falloff. m; 1e15 and more without fog.
float fadingLength(float place) {
    float fading = 1e-15, falloff = 0;
    const float y = eye.position.y + place * ray_dir.y;
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i) {
        fading += 2 * tick.fogs[i].sigma_t * exp(min(-tick.fogs[i].falloff * (y - tick.fogs[i].base), 60));
        falloff = max(falloff, tick.fogs[i].falloff);
    }
    return 1 / (fading + falloff * abs(ray_dir.y));
}

// Breaks of the ray where fog thins out with height, which the angle from a light does not follow: on both sides of the
// place where most of it is seen. That is where the ray enters it from above to an optical depth of 1, or the ray's
// dense end. m from the eye; 1e15 without such fog.
vec4 fogBreaks(vec2 ends) {
    float sigma = 0, growth = 0; // at the eye, and with each metre of the ray
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i) {
        const float g = -tick.fogs[i].falloff * ray_dir.y;
        if (abs(g) <= abs(growth)) continue;
        growth = g;
        sigma = tick.fogs[i].sigma_t * exp(min(-tick.fogs[i].falloff * (eye.position.y - tick.fogs[i].base), 60));
    }
    if (abs(growth) < 1e-12) return vec4(1e15);
    float dense = ends.x;
    if (growth > 0) dense = clamp(log(1 + growth / max(sigma, 1e-30)) / growth, ends.x, ends.y);
    return dense + vec4(-3, -1, 1, 3) / abs(growth);
}

// What a piece of the ray scatters of a light of intensity 1. The piece lies within each fog or outside it, and within
// one slab or where there are no particles. `closest`: the place closest to the light; begin and end count from there;
// slab: slabs_before for none; before: optical depth of the particles in front of the slab.
vec3 ofPiece(LocalLight light, float closest, vec3 offset, float begin, float end, uint slab, float before,
             ivec2 pixel) {
    const bool in_slab = slab < slabs_before;
    const float particles = in_slab ? depth_to[slab + 1] - depth_to[slab] : 0;
    if (!kHasFog && !(particles > 0)) return vec3(0);
    const float offset2 = dot(offset, offset), h = sqrt(offset2 + light.radius * light.radius);
    const EquiangularPart part = equiangularPart(h, begin, end);
    const float from = closest + begin, fog_before = fogTo(from), fog = fogTo(closest + end) - fog_before;
    if (!(particles + fog > 0)) return vec3(0);
    if (before + fog_before > kDeep) return vec3(0);
    const float nearest = begin > 0 ? begin : end < 0 ? -end : 0;
    const float size = max((end - begin) * inversesqrt(nearest * nearest + h * h), particles + fog);
    const float wanted = max(part.angle / kMostAngle, (particles + fog) / kMostDepth);
    const GrownSlab grown = in_slab ? growthOf(slab) : grownSlab(-70, -70, -70);
    const bool whole = !in_slab || end - begin > 0.999 * slab_length; // only then its mean extinction is known
    const bool is_tiny = size < kTiny && whole, is_short = size < kShort && abs(grown.growth) < kMostGrowth;
    const uint nodes = is_tiny ? 1 : is_short ? 2 : 4; // that a panel has
    const uint panels = nodes < 4 ? 1 : uint(clamp(ceil(wanted), 1, float(kMostPanels)));
    const vec3 albedo = in_slab ? albedoOf(slab, pixel) : vec3(0);
    // One node has the mean extinction, and the place where that is: light is taken as linear.
    const float shift = is_tiny ? grownShift(grown) * (end - begin) * particles / (particles + fog) : 0;
    vec3 sum = vec3(0);
    uint node = 0;
    [[dont_unroll]] do {
        // Gauss and Legendre's: places in a panel of width 1, and weights.
        const uint i = node % nodes;
        const bool outer = i == 0 || i == 3;
        const float apart = nodes == 4 ? (outer ? 0.430568156 : 0.169990522) : nodes == 2 ? 0.288675135 : 0;
        const float weight = nodes == 4 ? (outer ? 0.173927423 : 0.326072577) : 1 / float(nodes);
        const float u = (float(node / nodes) + 0.5 + (2 * i < nodes ? -apart : apart)) / float(panels);
        const float even = clamp(equiangularPlace(part, u), begin, end), t = even + shift, place = closest + t;
        const vec3 away = offset + t * ray_dir;
        const float distance = sqrt(offset2 + t * t);
        const float sent = sentTo(light, away, distance);
        float passed = before + fogTo(place) + fogFrom(light, away, distance) +
                       particlesFrom(light, away, distance);
        const vec3 w = away / max(distance, 1e-20);
        vec3 source = vec3(0);
        if (in_slab) {
            const GrownPlace here = grownPlace(grown, (place - particle_begin) / slab_length - float(slab));
            const float extinction = particles / slab_length * (is_tiny ? 1 : here.extinction);
            passed += particles * here.before;
            source = albedo * (extinction * phaseAt(tick.phase, w));
        }
        [[dont_unroll]] for (uint f = 0; f < fogCount(); ++f) {
            if (place < fog_parts[f].begin || place > fog_parts[f].end) continue;
            const float height = eye.position.y + place * ray_dir.y - tick.fogs[f].base;
            const float sigma = tick.fogs[f].sigma_t * exp(min(-tick.fogs[f].falloff * height, 60));
            source += tick.fogs[f].albedo * (sigma * phaseAt(tick.fogs[f].phase, w));
        }
        const float falls = is_tiny ? (even * even + h * h) / (t * t + h * h) : 1; // the angle is even in that
        sum += source * (weight * sent * falls * exp(-passed));
    } while (++node < nodes * panels);
    return sum * (equiangularWeight(part) / float(panels));
}

// Brings `next` to the end of the piece of medium that begins at `at`: where a fog begins or ends, or a slab that has
// particles. Both count from `closest`. Returns the piece's slab; slabs_before: none. `before`: optical depth of the
// particles in front of it.
uint pieceFrom(float at, float closest, inout float next, out float before) {
    before = 0;
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i) {
        const vec2 ends = vec2(fog_parts[i].begin, fog_parts[i].end) - closest;
        if (ends.x > at) next = min(next, ends.x);
        if (ends.y > at) next = min(next, ends.y);
    }
    if (slabs_before == 0) return slabs_before;
    const float first = particle_begin - closest;
    if (first > at) {
        next = min(next, first);
        return slabs_before;
    }
    uint slab = uint(clamp((at - first) / slab_length, 0, float(slabs_before)));
    if (!(first + float(slab + 1) * slab_length > at)) ++slab; // rounded down to the face that it is at
    slab = min(slab, slabs_before);
    const uint here = slab;
    [[dont_unroll]] while (slab < slabs_before && depth_to[slab + 1] - depth_to[slab] < kNoDepth) ++slab;
    before = depth_to[slab];
    if (slab < slabs_before) next = min(next, first + float(slab == here ? slab + 1 : slab) * slab_length);
    return slab == here ? slab : slabs_before;
}

// Keeps the shadow of object `o` if the ray meets it in `part`.
void findShadow(uint o, vec3 light, vec3 offset, vec2 part) {
    const vec2 range = hiddenFrom(objects[o], light, offset, ray_dir);
    if (max(range.x, part.x) < min(range.y, part.y)) addShadow(range);
}

const float kMeshGap = 1e-4; // m: shadows of triangles beside each other are less apart

// Keeps the shadows that meshes under a light throw on a part of the ray; see findShadows().
void findMeshShadows(vec3 light, vec3 offset, vec2 part, vec3 a, vec3 b, vec3 normal) {
    [[dont_unroll]] for (uint i = 0; i < meshNodes();) {
        const ObjectNode node = mesh_nodes[i];
        const bool met = meetsTriangle(node, light, a, b, normal);
        if (met && node.object != kInnerNode) {
            vec2 range = hiddenFrom(triangles[node.object], light, offset, ray_dir);
            range = vec2(max(range.x, part.x), min(range.y, part.y));
            if (range.x < range.y) joinShadow(range, kMeshGap);
        }
        i = met ? i + 1 : node.next;
    }
}

// Keeps the shadows that objects under a light throw on a part of the ray.
void findShadows(LocalLight light, vec3 offset, vec2 part) {
    [[dont_unroll]] for (uint o = 0; o < tick.plane_count; ++o) findShadow(o, light.position, offset, part);
    const vec3 from = light.position + offset, normal = cross(offset, ray_dir);
    const vec3 a = from + part.x * ray_dir, b = from + part.y * ray_dir;
    [[dont_unroll]] for (uint i = 0; i < objectNodes();) {
        const ObjectNode node = object_nodes[i];
        const bool met = meetsTriangle(node, light.position, a, b, normal);
        if (met && node.object != kInnerNode) findShadow(node.object, light.position, offset, part);
        i = met ? i + 1 : node.next;
    }
    if (kHasMeshes) findMeshShadows(light.position, offset, part, a, b, normal);
}

// The first of four places that lies behind `at`; 1e30: none does.
float firstBehind(vec4 places, float at) {
    const vec4 behind = mix(vec4(1e30), places, greaterThan(places, vec4(at)));
    return min(min(behind.x, behind.y), min(behind.z, behind.w));
}

// The radiance that the ray has of one light.
vec3 ofLight(LocalLight light, ivec2 pixel) {
    const vec3 to = light.position - eye.position;
    const float closest = dot(to, ray_dir);
    const vec3 offset = closest * ray_dir - to;
    vec2 lit_range = vec2(eye.near_depth - closest, min(ray_end, 1e15) - closest);
    const float half2 = light.range * light.range - dot(offset, offset);
    if (half2 <= 0) return vec3(0);
    const float half_chord = sqrt(half2);
    lit_range = vec2(max(lit_range.x, -half_chord), min(lit_range.y, half_chord));
    vec2 inner = kNoneHidden;
    if (light.cos_outer > -1) {
        const vec2 outer = insideCone(light.axis, light.cos_outer, offset, ray_dir);
        lit_range = vec2(max(lit_range.x, outer.x), min(lit_range.y, outer.y));
        inner = insideCone(light.axis, light.cos_outer + light.cone_width, offset, ray_dir);
    }
    if (!(lit_range.x < lit_range.y)) return vec3(0);
    shadow_count = 0;
    if (light.shadows != 0) findShadows(light, offset, lit_range);
    const vec2 off = min(kFogBreaks * fadingLength(clamp(closest, eye.near_depth, ray_end)),
                         vec2(kRangeBreak, 1) * half_chord);
    const vec4 breaks = vec4(-off.y, -off.x, off);
    vec4 fog_breaks;
    if (kHasFog) fog_breaks = fogBreaks(lit_range + closest) - closest;
    vec3 sum = vec3(0);
    float at = lit_range.x;
    [[dont_unroll]] for (uint piece = 0; piece < kMostPieces && at < lit_range.y; ++piece) {
        float next = lit_range.y;
        bool is_hidden = false; // another object may hide the light where one ends to
        [[dont_unroll]] for (uint i = 0; i < shadow_count; ++i) {
            if (shadows[i].x > at) next = min(next, shadows[i].x);
            else if (shadows[i].y > at) {
                at = shadows[i].y;
                is_hidden = true;
            }
        }
        if (!is_hidden) {
            float before;
            const uint slab = pieceFrom(at, closest, next, before);
            if (inner.x > at) next = min(next, inner.x);
            if (inner.y > at) next = min(next, inner.y);
            next = min(next, firstBehind(breaks, at));
            if (kHasFog) next = min(next, firstBehind(fog_breaks, at));
            sum += ofPiece(light, closest, offset, at, next, slab, before, pixel);
            at = next;
        }
    }
    return light.intensity * sum;
}

// True if nodes may miss what the light does to the ray: it passes the light's image, the thin part of its cone or the
// thin layer of fog that it lights.
bool isNear(LocalLight light) {
    const vec3 to = light.position - eye.position;
    const float along = dot(to, ray_dir), pixel = length(eye.ray_down) * along;
    if (!(along > 0)) return false;
    // Across the ray: the cone's axis, as far as the cone is thin, and the ray's place from its tip.
    const vec3 axis = light.axis - dot(light.axis, ray_dir) * ray_dir, off = along * ray_dir - to;
    const float sine = sqrt(max(1 - light.cos_outer * light.cos_outer, 1e-8));
    const float thin = light.cos_outer > 0 ? kThin * pixel * light.cos_outer / sine : 0;
    const float place = clamp(dot(off, axis) / max(dot(axis, axis), 1e-12), 0, thin);
    if (length(off - place * axis) < kCore * pixel) return true;
    float layer = 1e15; // m, height in which fog thins out
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i) layer = min(layer, 1 / max(tick.fogs[i].falloff, 1e-15));
    return layer < kThin * pixel && abs(off.y) < kCore * pixel;
}

// Finds lights that are so near to the pixel's ray that nodes may miss what they do.
void findNearLights(uvec2 pixel) {
    ray_dir = normalize(rayDirection(vec2(pixel) + 0.5));
    const uint bin = binOf(pixel);
    [[dont_unroll]] for (uint word = 0; word < lightWords(); ++word) {
        uint near = 0;
        [[dont_unroll]] for (uint bits = light_bits[bin + word]; bits != 0; bits &= bits - 1) {
            const LocalLight light = local_lights[32 * word + findLSB(bits)];
            if (!isOnRays(light) && isNear(light)) near |= bits & -bits;
        }
        if (near != 0) {
            atomicOr(near_lights[word], near);
            atomicOr(any_is_near, 1);
        }
    }
}

// True if a light may reach a bin of pixels that rays do not hold, of those that a word has.
bool isAnyNeeded(uint bin, uint word) {
    uint bits = light_bits[bin + word];
    if (!kLampsOnRays) return bits != 0;
    [[dont_unroll]] for (; bits != 0; bits &= bits - 1)
        if (!isOnRays(local_lights[32 * word + findLSB(bits)])) return true;
    return false;
}

// The light of a pixel's ray of near lights, of the others, or of both; but for what rays hold.
vec3 ofPixel(uvec2 pixel, float depth, bool of_near, bool of_others) {
    const uint bin = binOf(pixel);
    const vec3 dir = rayDirection(vec2(pixel) + 0.5);
    const float metres = length(dir);
    ray_dir = dir / metres;
    ray_end = depth * metres;
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i)
        fog_parts[i] = partInFog(i, eye.position, ray_dir, eye.near_depth * metres, ray_end);
    readParticles(ivec2(pixel), metres);
    vec3 sum = vec3(0);
    [[dont_unroll]] for (uint word = 0; word < lightWords(); ++word) {
        const uint near = near_lights[word], wanted = (of_near ? near : 0) | (of_others ? ~near : 0);
        [[dont_unroll]] for (uint bits = light_bits[bin + word] & wanted; bits != 0; bits &= bits - 1) {
            const LocalLight light = local_lights[32 * word + findLSB(bits)];
            if (!isOnRays(light)) sum += ofLight(light, ivec2(pixel));
        }
    }
    return sum;
}

