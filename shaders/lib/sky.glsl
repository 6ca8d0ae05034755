// Radiance of a surface that is `distance` (m) away: the air between fades it to the horizon.
vec3 throughHaze(vec3 surface, float distance) {
    return tick.haze > 0 ? mix(tick.sky_horizon, surface, exp(-tick.haze * distance)) : surface;
}

// Radiance of the sky in the unit direction `w`; include after the tick is declared.
vec3 skyRadiance(vec3 w) { return mix(tick.sky_horizon, tick.sky_zenith, smoothstep(-0.15, 0.85, w.y)); }
