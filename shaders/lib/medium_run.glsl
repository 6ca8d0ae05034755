// What the medium makes of the background in a run of pixels, from a field of coarse rays. Where a pixel's opaque surface is not what
// the rays around it hit, and where shadows of objects begin and end in the medium, the field is looked up at the pixel's own depths.
// Include after the tick, the eye, `field`, `objects`, `view_depth` and the constants of compose.comp are declared.
#include "shaders/shared/phase.h"
#include "shaders/shared/transmittance.h"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/caster_shadow.glsl"
#include "shaders/lib/slab_field.glsl"

const float kSameFace = 0.1;              // of a slab: how far apart the pixel's surface and that of the rays around it may be
const uint kLit = kSources == 1 ? 1 : 3; // sources of what is scattered from the light; the others are ambient light's

// A run with what it has looked up.
struct MediumRun {
    FieldRun at;
    vec4 whole[kMostSources + 1], ends; // rays up to what they hit, and the face of that
    FieldFaces ended[kMostSources + 1], shadow_begin[3], shadow_end[3];
};

MediumRun mediumRun(uvec2 pixel) {
    MediumRun run;
    run.at = fieldRun(pixel);
    const vec4 down = spline(run.at.down);
    for (uint c = 0; c <= kSources; ++c) {
        run.whole[c] = fieldColumns(kRate == 1 ? fieldWhole(c) : fieldSpline(c), run.at, down);
        run.ended[c].below = -1;
    }
    for (uint c = 0; c < kLit; ++c) run.shadow_begin[c].below = run.shadow_end[c].below = -1;
    if (kHasOpaque) run.ends = fieldColumns(kRate == 1 ? fieldEnds() : fieldSpline(kSources + 1), run.at, down);
    return run;
}

// The runs of this row of pixels and of the next one of the same cells, without opaque objects.
void mediumRuns(uvec2 pixel, out MediumRun run, out MediumRun next) {
    run.at = fieldRun(pixel);
    next.at = fieldRun(pixel + uvec2(0, 1));
    for (uint c = 0; c <= kSources; ++c) {
        const mat2x4 rows = transpose(fieldColumnsOfTwo(fieldSpline(c), run.at, next.at));
        run.whole[c] = rows[0];
        next.whole[c] = rows[1];
    }
}

// Takes away what objects' shadows leave out of the light scattered before `end` (face); nearest first, so that overlaps count once.
void leaveOutShadows(inout float scattered[kMostSources], inout MediumRun run, vec3 dir, float end, float part) {
    float from = 0;
    for (uint n = push.grid.first_caster; n < tick.opaque_count; ++n) {
        vec2 next = vec2(1e30, 0);
        for (uint o = push.grid.first_caster; o < tick.opaque_count; ++o) {
            vec2 range = (shadowOf(objects[o], eye.position, dir) - push.grid.depth) / push.grid.thickness;
            range = vec2(max(range.x, from), min(range.y, end));
            if (range.x < range.y && range.x < next.x) next = range;
        }
        if (!(next.x < next.y)) break;
        for (uint c = 0; c < kLit; ++c) {
            const uint set = (c + 1) * fieldSet();
            const float lost = fieldAt(run.shadow_end[c], set, run.at, next.y, part) - fieldAt(run.shadow_begin[c], set, run.at, next.x, part);
            scattered[c] = max(scattered[c] - lost, 0);
        }
        from = next.y;
    }
}

// `behind`: radiance and transmittance of what a pixel of the run shows without the medium, looking along `dir` of unit view depth.
vec4 throughMedium(inout MediumRun run, uvec2 pixel, vec3 dir, vec4 behind) {
    const float part = fieldPart(pixel.x);
    const vec4 across = kRate == 1 ? vec4(1, 0, 0, 0) : spline(part);
    float depth = max(dot(across, run.whole[0]), 0), scattered[kMostSources];
    for (uint c = 0; c < kSources; ++c) scattered[c] = max(dot(across, run.whole[c + 1]), 0) * opacity(depth);
    if (kHasOpaque) {
        const float z = texelFetch(view_depth, ivec2(pixel), 0).r;
        const float end = clamp((z - push.grid.depth) / push.grid.thickness, 0, float(push.grid.slabs));
        if (abs(dot(across, run.ends) - end) > kSameFace) {
            depth = max(fieldAt(run.ended[0], 0, run.at, end, part), 0);
            for (uint c = 0; c < kSources; ++c)
                scattered[c] = max(fieldAt(run.ended[c + 1], (c + 1) * fieldSet(), run.at, end, part), 0);
        }
        if (kHasCasters && depth > 0) leaveOutShadows(scattered, run, dir, end, part);
    }
    float phase = 0.07957747154594767;
    if (kHasLobe) phase = phaseMixture(-tick.to_light, -normalize(dir), tick.anisotropy, tick.asymmetry);
    const float opaque_part = opacity(depth);
    vec3 light;
    if (kSources == 1) {
        light = push.grid.albedo * tick.irradiance * (phase * scattered[0]);
        if (kHasAmbient) light += push.grid.albedo * tick.ambient * opaque_part;
    } else {
        for (uint c = 0; c < 3; ++c) light[c] = tick.irradiance[c] * phase * scattered[c];
        if (kSources == 6)
            for (uint c = 0; c < 3; ++c) light[c] += tick.ambient[c] * scattered[min(c + 3, kSources - 1)];
    }
    return vec4(light, 0) + (1 - opaque_part) * behind;
}
