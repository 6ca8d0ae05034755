// Where a pixel's opaque surface is not what the rays around it hit, and where shadows of objects begin and end in the medium, the
// field is looked up at the pixel's own depths. Include after lib/medium_run.glsl, kHasCasters, `objects` and `view_depth`.
#include "shaders/lib/objects.glsl"
#include "shaders/lib/caster_shadow.glsl"

const float kSameFace = 0.1;              // of a slab: how far apart the pixel's surface and that of the rays around it may be
const uint kLit = kSources == 1 ? 1 : 3; // sources of what is scattered from the light; the others are ambient light's

// What a run has looked up for it.
struct MediumCut {
    vec4 ends; // the face of what whole rays hit
    FieldFaces ended[kMostSources + 1], shadow_begin[3], shadow_end[3];
};

MediumCut mediumCut(MediumRun run) {
    MediumCut cut;
    for (uint c = 0; c <= kSources; ++c) cut.ended[c].below = -1;
    for (uint c = 0; c < kLit; ++c) cut.shadow_begin[c].below = cut.shadow_end[c].below = -1;
    if (kHasOpaque) cut.ends = fieldColumns(kRate == 1 ? fieldEnds() : fieldSpline(kSources + 1), run.at, spline(run.at.down));
    return cut;
}

// Takes away what objects' shadows leave out of the light scattered before `end` (face); nearest first, so that overlaps count once.
void leaveOutShadows(inout float scattered[kMostSources], inout MediumCut cut, MediumRun run, vec3 dir, float end, float part) {
    float from = 0;
    for (uint n = grid.first_caster; n < tick.opaque_count; ++n) {
        vec2 next = vec2(1e30, 0);
        for (uint o = grid.first_caster; o < tick.opaque_count; ++o) {
            vec2 range = (shadowOf(objects[o], eye.position, dir) - grid.depth) / grid.thickness;
            range = vec2(max(range.x, from), min(range.y, end));
            if (range.x < range.y && range.x < next.x) next = range;
        }
        if (!(next.x < next.y)) break;
        for (uint c = 0; c < kLit; ++c) {
            const uint set = fieldSetOf(c + 1);
            const float lost = fieldAt(cut.shadow_end[c], set, run.at, next.y, part) - fieldAt(cut.shadow_begin[c], set, run.at, next.x, part);
            scattered[c] = max(scattered[c] - lost, 0);
        }
        from = next.y;
    }
}

// Makes of a whole ray (wholeRay()) the pixel's own. `dir`: of unit view depth.
void cutRay(inout MediumCut cut, MediumRun run, ivec2 pixel, vec3 dir, vec4 across, inout float depth, inout float scattered[kMostSources]) {
    const float part = fieldPart(pixel.x), z = texelFetch(view_depth, pixel, 0).r;
    const float end = clamp((z - grid.depth) / grid.thickness, 0, float(grid.slabs));
    if (abs(dot(across, cut.ends) - end) > kSameFace) {
        depth = max(fieldAt(cut.ended[0], fieldSetOf(0), run.at, end, part), 0);
        for (uint c = 0; c < kSources; ++c) scattered[c] = max(fieldAt(cut.ended[c + 1], fieldSetOf(c + 1), run.at, end, part), 0);
    }
    if (kHasCasters && depth > 0) leaveOutShadows(scattered, cut, run, dir, end, part);
}
