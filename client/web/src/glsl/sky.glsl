uniform vec3 zenith, horizon;
vec3 skyRadiance(vec3 w) { return mix(horizon, zenith, skyZenithPart(w.y)); }
