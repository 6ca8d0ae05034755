// Light of particles that is the same wherever they are: what they scatter of the sky's uniform light and what they
// emit. Include after kHasAmbient is declared.
#ifndef BRUME_EVEN_LIGHT
#define BRUME_EVEN_LIGHT
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/has_emission.glsl"
#include "shaders/shared/emission.h"

// Radiance of what hides `hidden` of all behind it; `scattering`: the same times albedo.
vec3 evenLight(float hidden, vec3 scattering) {
    vec3 light = vec3(0);
    if (kHasAmbient) light += tick.ambient * scattering;
    if (kHasEmission) light += emitted(tick.emission, tick.cold_albedo, hidden, scattering);
    return light;
}
#endif
