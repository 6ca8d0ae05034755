#include "shaders/blocks/tick.glsl"
#include "shaders/shared/sky.h"

// Radiance of the sky in the unit direction `w`; include after the tick is declared.
vec3 skyRadiance(vec3 w) { return mix(tick.sky_horizon, tick.sky_zenith, skyZenithPart(w.y)); }

// Radiance of a surface that is seen along the unit direction `w`, `distance` (m) away: the air between fades it to the
// sky.
vec3 throughHaze(vec3 surface, float distance, vec3 w) {
    return tick.haze > 0 ? mix(skyRadiance(w), surface, exp(-tick.haze * distance)) : surface;
}

// Irradiance over pi of a surface with unit normal `n` by the sky above the horizon, past no object or medium.
vec3 skyLight(vec3 n) {
    return tick.sky_horizon * skySeen(n.y) + (tick.sky_zenith - tick.sky_horizon) * skyZenithSeen(n.y);
}
