// What a ray's light is stored as a part of, in scenes with fog: the same at rays and at pixels. Include after
// lib/view.glsl, lib/field_planes.glsl and lib/fog.glsl.
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/phase.h"

const float kLeastScale = 1e-20; // below it nothing is seen
const float kLeastSeen = 1e-3; // of particles, through fog

// Phase function of a fog, as a factor of its light in the field: 1 where all fogs have one, which is left to pixels.
float fogPhase(uint i, vec3 w) {
    if (tick.fog_phases == 1) return 1;
    const Phase p = tick.fogs[i].phase;
    return phaseOfLobes(-tick.sun.to_light, -w, p.part, p.asymmetry, p.draine, p.second);
}

// Of each light quantity what it would be if nothing stood between the medium and its light, particles and fog did not
// hide each other, and all particles were in the middle of their slabs. `dir`: of unit view depth; `end`: view depth
// where the ray ends; `particles`: optical depth of the particles before it. Returns that of fog.
float fieldScale(vec3 dir, float end, float particles, out float scale[kMostFieldQuantities]) {
    const float metres = length(dir), middle = 0.5 * (grid.depth + farDepth());
    float shares[kMostFogs];
    const float fog = fogShares(eye.position, dir, metres, eye.near_depth, end, shares);
    const float before = fogBetween(eye.position, dir, metres, eye.near_depth, min(middle, end));
    const float seen = opacity(particles) * max(exp(-before), kLeastSeen);
    for (uint q = 0; q < fieldQuantities(); ++q) scale[q] = 0;
    for (uint c = 0; c < kSunColours; ++c) scale[kFieldSun + c] = seen;
    for (uint c = 0; c < kAmbientColours; ++c) scale[fieldAmbient() + c] = seen;
    for (uint c = 0; c < kMultipleColours; ++c) scale[fieldMultiple() + c] = seen;
    for (uint c = 0; c < 3 && holdsGlow(); ++c) scale[fieldGlow() + c] = seen * tick.emission[c];
    [[dont_unroll]] for (uint i = 0; i < tick.fog_count; ++i) {
        const float phase = fogPhase(i, dir / metres);
        for (uint c = 0; c < 3; ++c) {
            scale[fieldFog() + c] += tick.fogs[i].albedo[c] * phase * shares[i];
            if (kHasGlow) scale[fieldGlow() + c] += tick.fogs[i].emission[c] * shares[i];
        }
        for (uint c = 0; c < kAmbientColours; ++c) scale[fieldAmbient() + c] += tick.fogs[i].albedo[c] * shares[i];
    }
    return fog;
}
