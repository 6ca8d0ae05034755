// Looks the field up at a pixel's own depths, at the edges of objects and shadows: where the pixel's opaque surface
// differs from that of the rays around it, and where shadows of objects begin and end. Include after
// lib/medium_run.glsl, kHasCasters, `objects`, `view_depth`, and what lib/mesh_shadow.glsl needs.
#include "shaders/lib/objects.glsl"
#include "shaders/lib/casters_met.glsl"
#include "shaders/lib/shadow_list.glsl"
#include "shaders/lib/mesh_shadow.glsl"

const float kSameHeight = 1e-2; // of a plane: most that its points differ by, as a part of their height
const float kSameFace = 0.1; // of a slab: most distance of the pixel's surface from that of its rays

const uint kFurther = 1u << 31; // bit of TileCasters for all casters after the first 31

// Casters whose shadow a run of pixels may meet.
struct TileCasters {
    uint words; // index in the field of the words of their tile
    uint met;   // bits: the tile's first caster, its second one ...; see kFurther
};

// Values that a run of pixels shares.
struct MediumCut {
    vec4 ends;    // the face at which whole rays end
    bool steep;   // true: the ends of the rays around are steep (shared/field.h)
    TileCasters casters;
    FieldFaces ended[kMostFieldQuantities], shadow_begin[6], shadow_end[6]; // shadows: each colour of the sun
};

// Quantities that shadows take from: the sun's colours on particles, then on fog.
uint shadowedQuantities() { return kSunColours + (kHasFog ? 3 : 0); }
uint shadowedQuantity(uint n) { return n < kSunColours ? kFieldSun + n : fieldFog() + n - kSunColours; }

// The face of a view depth, clamped, and the part of a slab, of a pixel's own ray. In slabs of fog alone the part is
// that of the opacity, with which light grows.
float faceOnRay(float depth, vec3 dir) {
    const float at = clamp(faceAt(depth), 0, float(lastFace()));
    const float face = min(floor(at), float(lastFace() - 1));
    if (!isFogAlone(uint(face))) return at;
    const float near = faceDepth(uint(face)), far = faceDepth(uint(face) + 1), metres = length(dir);
    const float whole = opacity(fogBetween(eye.position, dir, metres, near, far));
    const float part = opacity(fogBetween(eye.position, dir, metres, near, clamp(depth, near, far)));
    return face + min(part / max(whole, 1e-30), 1);
}

// A quantity up to a face. Fog's columns are not kept for the next pixel: kept arrays of all its quantities take
// seconds to compile.
float cutAt(inout FieldFaces kept, uint quantity, MediumRun run, float face, float part) {
    if (!kHasFog) return fieldAt(kept, quantity, run.at, face, part);
    FieldFaces none;
    none.below = -1;
    return fieldAt(none, quantity, run.at, face, part);
}

// The casters of `pixels` pixels from `pixel` on: those of the first one's tile, which reaches as far as eight pixels
// do that begin at a multiple of eight.
TileCasters castersOfPixels(ivec2 pixel, ivec2 pixels) {
    TileCasters casters = TileCasters(fieldKept(fieldNode(pixel) / kSlabTile) + kFieldKept, 0);
    if (!kHasCasters) return casters;
    float far = 0;
    if (kHasFog)
        for (int y = 0; y < pixels.y; ++y)
            for (int x = 0; x < pixels.x; ++x)
                far = max(far, texelFetch(view_depth, min(pixel + ivec2(x, y), ivec2(eye.size) - 1), 0).r);
    const vec2 middle = vec2(pixel) + 0.5 * vec2(pixels);
    const float radius = 0.5 * length(vec2(pixels));
    uint n = 0;
    for (uint word = 0; word < grid.caster_words; ++word)
        for (uint bits = uint(field[casters.words + word]); bits != 0; bits &= bits - 1) {
            const uint o = tick.plane_count + kWordCasters * word + findLSB(bits);
            if (n < 31 && meetsShadow(o, middle, radius, far)) casters.met |= 1u << n;
            if (n == 31) casters.met |= kFurther;
            ++n;
        }
    return casters;
}

// The shared values of pixels from `pixel` on, with `casters` of them.
MediumCut mediumCut(MediumRun run, ivec2 pixel, TileCasters casters) {
    MediumCut cut;
    cut.casters = casters;
    for (uint q = 0; q < fieldQuantities(); ++q) cut.ended[q].below = -1;
    for (uint n = 0; n < shadowedQuantities(); ++n) cut.shadow_begin[n].below = cut.shadow_end[n].below = -1;
    cut.steep = false;
    if (kHasOpaque) {
        cut.ends = fieldColumns(kRate == 1 ? fieldEnd() : fieldEndSpline(), run.at, spline(run.at.down));
        // The nodes above and below the run: coefficients of a spline ring to two nodes around.
        const uint upper = fieldSteep() + run.at.first + grid.nodes.x + 1;
        if (kRate > 1) cut.steep = max(field[upper], field[upper + grid.nodes.x + 1]) > 0;
    }
    return cut;
}

// Subtracts the sun's light that objects' shadows remove before view depth `end`. Shadows that overlap are joined, so
// that they count once.
void leaveOutShadows(inout float ray[kMostFieldQuantities], inout MediumCut cut, MediumRun run, vec3 dir, float end,
                     float part) {
    const float begin = kHasFog ? eye.near_depth : grid.depth;
    end = min(end, faceDepth(lastFace()));
    shadow_count = 0;
    uint n = 0;
    for (uint word = 0; word < grid.caster_words; ++word)
        for (uint bits = uint(field[cut.casters.words + word]); bits != 0; bits &= bits - 1) {
            if ((cut.casters.met >> min(n++, 31) & 1) == 0) continue;
            const uint o = tick.plane_count + kWordCasters * word + findLSB(bits);
            vec2 range = shadowOf(objects[o], eye.position, dir);
            range = vec2(max(range.x, begin), min(range.y, end));
            if (range.x < range.y) addShadow(range);
        }
    if (kHasMeshes) walkShadowMap(eye.position, dir, begin, end);
    while (shadow_count > 0) {
        vec2 joined = shadows[--shadow_count];
        for (uint i = 0; i < shadow_count;) {
            const vec2 other = shadows[i];
            if (other.x > joined.y || other.y < joined.x) {
                ++i;
                continue;
            }
            joined = vec2(min(joined.x, other.x), max(joined.y, other.y));
            shadows[i] = shadows[--shadow_count];
            i = 0; // what is longer now may meet those before
        }
        const vec2 faces = kHasFog ? vec2(faceOnRay(joined.x, dir), faceOnRay(joined.y, dir)) : facesAt(joined);
        for (uint n = 0; n < shadowedQuantities(); ++n) {
            const uint q = shadowedQuantity(n);
            const float lost = cutAt(cut.shadow_end[n], q, run, faces.y, part) -
                               cutAt(cut.shadow_begin[n], q, run, faces.x, part);
            ray[q] = max(ray[q] - lost, 0);
        }
    }
}

// True if the four nearest rays end on the same horizontal plane as the pixel, `height` above the eye, or in the sky.
// `behind`: true if all of them, and the pixel's own, at face `own`, end behind the particles.
bool isLevel(MediumRun run, ivec2 pixel, float height, float own, out bool behind) {
    const uvec2 first = fieldNode(pixel) + 1;
    const float last = float(grid.front + grid.slabs);
    bool level = true;
    behind = own >= last;
    [[dont_unroll]] for (uint n = 0; n < 4; ++n) {
        const uvec2 node = first + uvec2(n & 1, n >> 1);
        const float face = field[fieldEnd() + node.y * grid.nodes.x + node.x];
        const vec2 at = (vec2(node) + vec2(0, grid.first_row) - float(grid.margin)) * float(grid.rate) + 0.5;
        behind = behind && face >= last;
        const float there = faceDepth(face) * rayDirection(at).y;
        level = level && (face >= float(lastFace()) || abs(there - height) < kSameHeight * abs(height));
    }
    return level;
}

// Changes the quantities of a whole ray (wholeRay()) to those of the pixel's own ray. `dir`: ray direction of unit view
// depth.
void cutRay(inout MediumCut cut, MediumRun run, ivec2 pixel, vec3 dir, vec4 across,
            inout float ray[kMostFieldQuantities]) {
    const float part = fieldPart(pixel.x), z = texelFetch(view_depth, pixel, 0).r;
    const float linear = clamp(faceAt(z), 0, float(lastFace()));
    const bool differs = abs(dot(across, cut.ends) - linear) > kSameFace;
    bool keep_fog = false, keep_all = false; // True: what is before the surface is that of the whole rays
    if (kHasFog && (cut.steep || differs)) keep_fog = !differs;
    if (kHasFog && kRate > 1 && (cut.steep || differs)) {
        const bool level = isLevel(run, pixel, z * dir.y, linear, keep_all);
        keep_fog = keep_fog || level;
        keep_all = keep_all && level;
    }
    if ((cut.steep || differs) && !keep_all) {
        const float end = kHasFog ? faceOnRay(z, dir) : linear;
        for (uint q = 0; q < fieldQuantities(); ++q)
            if (!(keep_fog && q >= fieldFog())) ray[q] = max(cutAt(cut.ended[q], q, run, end, part), 0);
        if (kHasFog) ray[kFieldDepth] += fogBefore(dir, z);
    }
    const bool may_be_dark = kHasCasters && (kHasMeshes || cut.casters.met != 0);
    if (may_be_dark && ray[kFieldDepth] > 0) leaveOutShadows(ray, cut, run, dir, z, part);
}
