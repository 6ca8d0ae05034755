// Puts the medium in front of the background in a run of pixels, from a field of coarse rays. Include after
// lib/view.glsl, lib/eye.glsl, `field`, kHasOpaque, kHasLobe, kHasAmbient, kRate, kSunColours, kAmbientColours,
// kMultipleColours and kScatteringModel are declared.
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/medium_phase.glsl"
#include "shaders/shared/transmittance.h"
#include "shaders/shared/multiple.h"
#include "shaders/lib/slab_field.glsl"
#include "shaders/lib/lone_fog.glsl"
#include "shaders/lib/field_scale.glsl"

// A run with the node columns of whole rays: the quantities of the field. Arrays have the largest size, since GLSL does
// not copy arrays of specialised sizes.
struct MediumRun {
    FieldRun at;
    vec4 whole[kMostFieldQuantities];
};

// True if no ray has medium that the run from `pixel` on, or the coefficients that it reads, are made of.
bool isClear(ivec2 pixel) {
    const uvec2 node = fieldNode(pixel);
    return isClear(max(node, 2) - 2, node + 5);
}

MediumRun mediumRun(ivec2 pixel) {
    MediumRun run;
    run.at = fieldRun(pixel);
    const vec4 down = spline(run.at.down);
    for (uint q = 0; q < fieldQuantities(); ++q)
        run.whole[q] = fieldColumns(kRate == 1 ? fieldWhole(q) : fieldSpline(q), run.at, down);
    return run;
}

// The runs of this row of pixels and of the next one in the same cells, without opaque objects.
void mediumRuns(ivec2 pixel, out MediumRun run, out MediumRun next) {
    run.at = fieldRun(pixel);
    next.at = fieldRun(pixel + ivec2(0, 1));
    for (uint q = 0; q < fieldQuantities(); ++q) {
        const mat2x4 rows = transpose(fieldColumnsOfTwo(fieldSpline(q), run.at, next.at));
        run.whole[q] = rows[0];
        next.whole[q] = rows[1];
    }
}

// Optical depth of fog between the eye and view depth `end` of a pixel's own ray: exact, so that no edge is smeared.
float fogBefore(vec3 dir, float end) {
    return kHasFog ? fogBetween(eye.position, dir, length(dir), eye.near_depth, end) : 0;
}

// The quantities of a pixel's whole ray; its depth is that of particles and fog. `dir`: of unit view depth; `end`: view
// depth where it ends.
void wholeRay(MediumRun run, vec4 across, vec3 dir, float end, out float ray[kMostFieldQuantities]) {
    ray[kFieldDepth] = isFogOnly() ? 0 : max(dot(across, run.whole[kFieldDepth]), 0); // rays are not made then
    if (kHasFog) {
        float scale[kMostFieldQuantities];
        const float fog = fieldScale(dir, end, ray[kFieldDepth], scale);
        if (isFogOnly()) { // the rest of the scale is exact
            const vec3 light = lightOfLoneFog(dir, vec2(eye.near_depth, end));
            for (uint q = 0; q < fieldQuantities(); ++q) ray[q] = scale[q];
            for (uint c = 0; c < 3; ++c) ray[fieldFog() + c] = light[c];
            ray[kFieldDepth] = fog;
            return;
        }
        for (uint q = kFieldSun; q < fieldQuantities(); ++q) ray[q] = max(dot(across, run.whole[q]), 0) * scale[q];
        ray[kFieldDepth] += fog;
        return;
    }
    for (uint q = kFieldSun; q < fieldQuantities(); ++q)
        ray[q] = max(dot(across, run.whole[q]), 0) * opacity(ray[kFieldDepth]);
}

// Radiance of the sun's light that particles and fogs scatter toward the eye. `ray`: the ray's quantities.
vec3 sunLight(vec3 dir, float ray[kMostFieldQuantities]) {
    float phase = 0.07957747154594767;
    if (kHasLobe) phase = mediumPhase(-tick.sun.to_light, -normalize(dir));
    vec3 light;
    if (kSunColours == 1) light = grid.albedo * tick.sun.irradiance * (phase * ray[kFieldSun]);
    else
        for (uint c = 0; c < 3; ++c) light[c] = tick.sun.irradiance[c] * phase * ray[kFieldSun + c];
    if (!kHasFog) return light;
    const Phase p = tick.fogs[0].phase; // fogPhase() left it out
    float fog_phase = 1;
    if (tick.fog_phases == 1)
        fog_phase = phaseOfLobes(-tick.sun.to_light, -normalize(dir), p.part, p.asymmetry, p.draine, p.second);
    for (uint c = 0; c < 3; ++c) light[c] += tick.sun.irradiance[c] * fog_phase * ray[fieldFog() + c];
    return light;
}

// Radiance of the medium in front of `behind` and its transmittance, along `dir`. `ray`: the ray's quantities.
// `sunlit`: the part of the sun's light that objects do not shadow.
vec4 mediumOver(vec4 behind, vec3 dir, float ray[kMostFieldQuantities], vec3 sunlit) {
    const float opaque_part = opacity(ray[kFieldDepth]);
    vec3 light = sunlit * sunLight(dir, ray);
    if (kSunColours == 1 && kHasAmbient && !kHasFog) light += grid.albedo * tick.ambient * opaque_part;
    for (uint c = 0; c < kAmbientColours; ++c) light[c] += tick.ambient[c] * ray[fieldAmbient() + c];
    if (kMultipleColours > 0) { // objects shadow octaves as they do the sun's light; fluxes know shadows already
        const vec3 part = tick.sun.irradiance * (kScatteringModel == kScatteringOctaves ? sunlit : vec3(1));
        for (uint c = 0; c < 3; ++c)
            light[c] += kMultipleColours == 1 ? grid.albedo[c] * part[c] * ray[fieldMultiple()] :
                                                part[c] * ray[fieldMultiple() + c];
    }
    if (kHasGlow)
        for (uint c = 0; c < 3; ++c) light[c] += ray[fieldGlow() + c];
    return vec4(light, 0) + (1 - opaque_part) * behind;
}
