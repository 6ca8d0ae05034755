// Light of the sun that has scattered more than once, in a slab of a ray. Include after the eye and its
// MapRays, kScatteringModel and kHasLobe are declared.
#include "shaders/blocks/fluence.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/multiple.h"
#include "shaders/shared/phase.h"
#include "shaders/lib/fluence_at.glsl"

float octave_phases[kOctaves]; // of the ray, 1/sr
float sun_phase;                   // of single scattering, 1/sr, > 0
vec3 toward_eye;                   // unit, along the axes of the fluxes

// Sets what a ray of direction `w`, unit, has.
void startMultiple(vec3 w) {
    if (kScatteringModel != kScatteringSingle) sun_phase = mediumPhase(-tick.sun.to_light, -w);
    if (kScatteringModel == kScatteringOctaves) {
        float part = 1;
        for (uint n = 1; n < kOctaves; ++n) {
            part *= kOctavePhase;
            octave_phases[n] = phaseOfLobes(-tick.sun.to_light, -w, tick.phase.part, part * tick.phase.asymmetry,
                                            part * tick.phase.draine, part * tick.phase.second);
        }
    } else if (kScatteringModel == kScatteringPropagation) {
        toward_eye = -vec3(dot(tick.map.x, w), dot(tick.map.y, w), -dot(tick.sun.to_light, w));
    }
}

// What a slab scatters toward the eye for E = 1, without albedo, before anything dims it. place: its middle in the
// volumetric shadow map; depth: its optical depth; light_in, light_out: light depth at its faces. straight: what has
// scattered straight on comes from the sun's direction, as sunlight does; for p E = 1.
vec3 multipleOfSlab(uint channels, vec3 place, float depth, float light_in, float light_out, out vec3 straight) {
    vec3 light = vec3(0);
    straight = vec3(0);
    if (kScatteringModel == kScatteringOctaves) {
        float scattering = 1, extinction = 1, sum = 0;
        for (uint n = 1; n < kOctaves; ++n) {
            scattering *= kOctaveScattering;
            extinction *= kOctaveExtinction;
            sum += scattering * octave_phases[n] *
                   scatterAnalytic(depth, extinction * light_in, extinction * light_out);
        }
        light = vec3(sum);
    } else if (kScatteringModel == kScatteringPropagation) {
        const float middle = 0.5 * (light_in + light_out), part = opacity(depth);
        for (uint c = 0; c < channels; ++c) {
            const uint channel = min(c, tick.multiple.channels - 1);
            const vec4 there = fluenceAt(channel, place);
            light[c] = part * scatteredFluence(there.w, there.xyz, tick.multiple.mean_cosine, toward_eye);
            straight[c] = part * (exp(-tick.multiple.passed[channel] * middle) - exp(-middle));
        }
    }
    return light;
}
