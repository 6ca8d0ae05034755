// Radiance of the sky in the unit direction `w`; include after the tick is declared.
vec3 skyRadiance(vec3 w) { return mix(tick.sky_horizon, tick.sky_zenith, smoothstep(-0.15, 0.85, w.y)); }
