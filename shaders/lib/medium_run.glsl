// Puts the medium in front of the background in a run of pixels, from a field of coarse rays. Include after the tick,
// lib/view.glsl, `field`, kHasOpaque, kHasLobe, kHasAmbient, kRate and kSources are declared.
#include "shaders/shared/phase.h"
#include "shaders/shared/transmittance.h"
#include "shaders/lib/slab_field.glsl"

// A run with the node columns of whole rays, which end at the surface that they hit: optical depth, then scattered
// light / opacity.
struct MediumRun {
    FieldRun at;
    vec4 whole[kMostSources + 1];
};

MediumRun mediumRun(ivec2 pixel) {
    MediumRun run;
    run.at = fieldRun(pixel);
    const vec4 down = spline(run.at.down);
    for (uint c = 0; c <= kSources; ++c)
        run.whole[c] = fieldColumns(kRate == 1 ? fieldWhole(c) : fieldSpline(c), run.at, down);
    return run;
}

// The runs of this row of pixels and of the next one in the same cells, without opaque objects.
void mediumRuns(ivec2 pixel, out MediumRun run, out MediumRun next) {
    run.at = fieldRun(pixel);
    next.at = fieldRun(pixel + ivec2(0, 1));
    for (uint c = 0; c <= kSources; ++c) {
        const mat2x4 rows = transpose(fieldColumnsOfTwo(fieldSpline(c), run.at, next.at));
        run.whole[c] = rows[0];
        next.whole[c] = rows[1];
    }
}

// Optical depth of a pixel's whole ray, and its scattered light from each source.
void wholeRay(MediumRun run, vec4 across, out float depth, out float scattered[kMostSources]) {
    depth = max(dot(across, run.whole[0]), 0);
    for (uint c = 0; c < kSources; ++c) scattered[c] = max(dot(across, run.whole[c + 1]), 0) * opacity(depth);
}

// Radiance of the medium in front of `behind` and its transmittance, along `dir`.
vec4 mediumOver(vec4 behind, vec3 dir, float depth, float scattered[kMostSources]) {
    float phase = 0.07957747154594767;
    if (kHasLobe) phase = phaseMixture(-tick.sun.to_light, -normalize(dir), tick.anisotropy, tick.asymmetry);
    const float opaque_part = opacity(depth);
    vec3 light;
    if (kSources == 1) {
        light = grid.albedo * tick.sun.irradiance * (phase * scattered[0]);
        if (kHasAmbient) light += grid.albedo * tick.ambient * opaque_part;
    } else {
        for (uint c = 0; c < 3; ++c) light[c] = tick.sun.irradiance[c] * phase * scattered[c];
        if (kSources == 6)
            for (uint c = 0; c < 3; ++c) light[c] += tick.ambient[c] * scattered[min(c + 3, kSources - 1)];
    }
    return vec4(light, 0) + (1 - opaque_part) * behind;
}
