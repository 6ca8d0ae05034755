// Light that the medium throws on surfaces. Include after lib/light.glsl.
#include "shaders/shared/constants.h"
#include "shaders/shared/glow.h"

layout(constant_id = kIdMediumGlow) const bool kMediumGlow = false; // True: surfaces get the medium's light
uniform sampler2DArray glow;                                        // net flux and fluence, [channel][z]

// Irradiance that it gives a surface of unit normal n at x. Beyond the nodes it falls as the light of a point.
vec3 mediumIrradiance(vec3 x, vec3 n) {
    const vec3 size = tick.map.hi - tick.map.lo, off = toLightSpace(x) - 0.5 * (tick.map.lo + tick.map.hi);
    vec3 part = vec3(off.xy, -off.z) / (kGlowReach * size);
    const float beyond = max(max(abs(part.x), abs(part.y)), max(abs(part.z), 1));
    part /= beyond;
    const float side = float(kGlowSide);
    const vec2 at = ((0.5 * part.xy + 0.5) * (side - 1) + 0.5) / side;
    const float z = (0.5 * part.z + 0.5) * (side - 1), below = clamp(floor(z), 0, side - 2);
    const vec3 across = vec3(dot(tick.map.x, n), dot(tick.map.y, n), -dot(tick.sun.to_light, n));
    vec3 sum = vec3(0);
    for (uint c = 0; c < tick.multiple.channels; ++c) {
        const float first = float(c) * side + below;
        const vec4 there =
            mix(textureLod(glow, vec3(at, first), 0), textureLod(glow, vec3(at, first + 1), 0), z - below);
        sum[c] = irradianceOf(there.w, there.xyz, across);
    }
    if (tick.multiple.channels == 1) sum = sum.xxx;
    return tick.multiple.irradiance * sum / (beyond * beyond);
}
