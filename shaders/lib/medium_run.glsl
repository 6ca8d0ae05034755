// Puts the medium in front of the background in a run of pixels, from a field of coarse rays. Include after
// lib/view.glsl, lib/eye.glsl, `field`, kHasOpaque, kHasLobe, kHasAmbient, kRate, kSunColours, kAmbientColours,
// kMultipleColours and kScatteringModel are declared.
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/even_light.glsl"
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
    vec4 ends;  // with opaque objects: the face at which whole rays end
    bool steep; // true: the ends of the rays around are steep (shared/field.h)
};

const int kNoCell = -2; // neither it nor the one beside it is any cell

// True if no ray has medium that the runs from `pixel` and from the one below it on, or the coefficients that they
// read, are made of.
bool areClear(ivec2 pixel) {
    const uvec2 node = fieldNode(pixel);
    return isClear(max(node, 2) - 2, node + (kRate % 2 == 0 ? 5 : 6));
}

// True: the ends of the rays around are steep, above or below the run. Coefficients of a spline ring to two nodes
// around.
bool isSteep(FieldRun run) {
    const uint upper = fieldSteep() + run.first + grid.nodes.x + 1;
    return kRate > 1 && max(field[upper], field[upper + grid.nodes.x + 1]) > 0;
}

// Moves two runs, one below the other, to `pixel` and the one below it. `cell`: the number across of the cell that they
// are in, or kNoCell. What they have of it and of the one beside it is kept.
void moveRuns(ivec2 pixel, inout int cell, inout MediumRun run, inout MediumRun next) {
    const FieldRows rows = fieldRows(pixel);
    const int own = int(fieldNode(pixel).x);
    if (own == cell) return;
    const bool beside = own == cell + 1;
    cell = own;
    run.at = rows.run;
    next.at = rows.next;
    for (uint q = 0; q < fieldQuantities(); ++q)
        if (isHeld(q))
            moveColumns(kRate == 1 ? fieldWhole(q) : fieldSpline(q), rows, beside, run.whole[q], next.whole[q]);
    if (!kHasOpaque) return;
    moveColumns(kRate == 1 ? fieldEnd() : fieldEndSpline(), rows, beside, run.ends, next.ends);
    run.steep = isSteep(run.at);
    next.steep = kRate % 2 == 0 ? run.steep : isSteep(next.at);
}

MediumRun mediumRun(ivec2 pixel) {
    MediumRun run, next;
    int cell = kNoCell;
    moveRuns(pixel, cell, run, next);
    return run;
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
        ray[q] = isHeld(q) ? max(dot(across, run.whole[q]), 0) * opacity(ray[kFieldDepth]) : 0;
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

// Radiance of the medium along `dir`. `ray`: its quantities. `opaque_part`: what it hides. `sunlit`: the part of the
// sun's light that objects do not shadow.
vec3 mediumLight(vec3 dir, float ray[kMostFieldQuantities], float opaque_part, vec3 sunlit) {
    vec3 light = sunlit * sunLight(dir, ray);
    if (kSunColours == 1 && !kHasFog) light += evenLight(opaque_part, grid.albedo * opaque_part);
    if (kHasAmbient)
        for (uint c = 0; c < kAmbientColours; ++c) light[c] += tick.ambient[c] * ray[fieldAmbient() + c];
    if (kMultipleColours > 0) { // objects shadow octaves as they do the sun's light; fluxes know shadows already
        const vec3 part = tick.multiple.irradiance * (kScatteringModel == kScatteringOctaves ? sunlit : vec3(1));
        for (uint c = 0; c < 3; ++c)
            light[c] += kMultipleColours == 1 ? grid.albedo[c] * part[c] * ray[fieldMultiple()] :
                                                part[c] * ray[fieldMultiple() + c];
    }
    if (holdsGlow())
        for (uint c = 0; c < 3; ++c) light[c] += ray[fieldGlow() + c];
    if (areLampsHeld())
        for (uint c = 0; c < 3; ++c) light[c] += ray[fieldLamps() + c];
    return light;
}

// Radiance of the medium in front of `behind` and its transmittance.
vec4 mediumOver(vec4 behind, vec3 dir, float ray[kMostFieldQuantities], vec3 sunlit) {
    const float opaque_part = opacity(ray[kFieldDepth]);
    return vec4(mediumLight(dir, ray, opaque_part, sunlit), 0) + (1 - opaque_part) * behind;
}
