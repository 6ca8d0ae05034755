// Looks the field up at a pixel's own depths, at the edges of objects and shadows: where the pixel's opaque surface
// differs from that of the rays around it, and where shadows of objects begin and end. Include after
// lib/medium_run.glsl, kHasCasters, `objects` and `view_depth`.
#include "shaders/lib/objects.glsl"
#include "shaders/lib/casters_met.glsl"

const float kSameFace = 0.1; // of a slab: most distance of the pixel's surface from that of its rays

// Values that a run of pixels shares.
struct MediumCut {
    vec4 ends;    // the face at which whole rays end
    bool steep;   // true: the ends of the rays around are steep (shared/field.h)
    uint casters; // bits of casters whose shadow the run may meet; see kFurther
    FieldFaces ended[kMostFieldQuantities], shadow_begin[3], shadow_end[3]; // shadows: each colour of the sun
};

// The shared values of `pixels` pixels from `pixel` on.
MediumCut mediumCut(MediumRun run, ivec2 pixel, uint pixels) {
    MediumCut cut;
    cut.casters = kHasCasters ? castersMet(vec2(pixel) + 0.5 * vec2(pixels, 1), 0.5 * float(pixels)) : 0;
    for (uint q = 0; q < fieldQuantities(); ++q) cut.ended[q].below = -1;
    for (uint c = 0; c < kSunColours; ++c) cut.shadow_begin[c].below = cut.shadow_end[c].below = -1;
    cut.steep = false;
    if (kHasOpaque) {
        cut.ends = fieldColumns(kRate == 1 ? fieldEnd() : fieldEndSpline(), run.at, spline(run.at.down));
        // The nodes above and below the run: coefficients of a spline ring to two nodes around.
        const uint upper = fieldSteep() + run.at.first + grid.nodes.x + 1;
        if (kRate > 1) cut.steep = max(field[upper], field[upper + grid.nodes.x + 1]) > 0;
    }
    return cut;
}

// Subtracts the sun's light that objects' shadows remove before `end` (face). Shadows are visited nearest first, so
// that overlaps count once: the nearest two, then those that begin behind them.
void leaveOutShadows(inout float ray[kMostFieldQuantities], inout MediumCut cut, MediumRun run, vec3 dir,
                     float end, float part) {
    const vec2 none = vec2(1e30, 0);
    vec2 first = none, second = none;
    float from = 0;
    bool more = true;
    while (true) { // a loop, so that the code exists once: it takes long to compile
        if (!(first.x < first.y)) {
            if (!more) break;
            uint found = 0;
            for (uint o = grid.first_caster; o < tick.opaque_count; ++o) {
                if ((cut.casters >> min(o - grid.first_caster, 31) & 1) == 0) continue;
                vec2 range = facesAt(shadowOf(objects[o], eye.position, dir));
                range = vec2(max(range.x, from), min(range.y, end));
                if (!(range.x < range.y)) continue;
                ++found;
                if (range.x < first.x || !(first.x < first.y)) second = first, first = range;
                else if (range.x < second.x) second = range;
            }
            more = found > 2;
            if (found == 0) break;
        }
        for (uint c = 0; c < kSunColours; ++c) {
            const uint q = kFieldSun + c;
            const float lost = fieldAt(cut.shadow_end[c], q, run.at, first.y, part) -
                               fieldAt(cut.shadow_begin[c], q, run.at, first.x, part);
            ray[q] = max(ray[q] - lost, 0);
        }
        from = first.y;
        first = vec2(max(second.x, from), second.y);
        second = none;
    }
}

// Changes the quantities of a whole ray (wholeRay()) to those of the pixel's own ray. `dir`: ray direction of unit view
// depth.
void cutRay(inout MediumCut cut, MediumRun run, ivec2 pixel, vec3 dir, vec4 across,
            inout float ray[kMostFieldQuantities]) {
    const float part = fieldPart(pixel.x), z = texelFetch(view_depth, pixel, 0).r;
    const float end = clamp(faceAt(z), 0, float(grid.slabs));
    if (cut.steep || abs(dot(across, cut.ends) - end) > kSameFace)
        for (uint q = 0; q < fieldQuantities(); ++q)
            ray[q] = max(fieldAt(cut.ended[q], q, run.at, end, part), 0);
    if (kHasCasters && cut.casters != 0 && ray[kFieldDepth] > 0) leaveOutShadows(ray, cut, run, dir, end, part);
}
