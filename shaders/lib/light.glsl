// Light at a point.
#include "shaders/blocks/opaque_shadow.glsl"
#include "shaders/blocks/shadow_volume.glsl"
#include "shaders/blocks/tick.glsl"

vec3 toLightSpace(vec3 x) { return vec3(dot(tick.map.x, x), dot(tick.map.y, x), dot(tick.sun.to_light, x)); }

vec3 fromLightSpace(vec3 at) { return at.x * tick.map.x + at.y * tick.map.y + at.z * tick.sun.to_light; }

// Position of a world point in the volumetric shadow map: texture coordinates, slice plane.
vec3 toShadowVolume(vec3 x) {
    return vec3(dot(tick.map.u, vec4(x, 1)), dot(tick.map.v, vec4(x, 1)), dot(tick.map.plane, vec4(x, 1)));
}

// Optical depth of the particles between such a position and the light, linear between texels and between planes. A
// layer holds four planes; its last is also the first of the next layer. So one filtered fetch has both neighbouring
// planes of any position.
float lightDepth(vec3 in_volume) {
    const float plane = clamp(in_volume.z, 0, float(tick.map.slices - 1));
    const float layer = min(floor(plane * 0.333333343), float((tick.map.slices - 2) / 3));
    const vec4 depth = textureLod(shadow_volume, vec3(in_volume.xy, layer), 0);
    const vec3 part = clamp(plane - 3 * layer - vec3(0, 1, 2), 0, 1);
    return tick.extinction * (depth.x + dot(part, depth.yzw - depth.xyz));
}

// The same anywhere: there is no medium beside the map and before its first plane.
float lightDepthAnywhere(vec3 in_volume) {
    const bool inside = in_volume.z > 0 && all(lessThan(abs(in_volume.xy - 0.5), vec2(0.5)));
    return inside ? lightDepth(in_volume) : 0;
}

// Visibility of the light past opaque objects from a light-space point: 1 or 0, from one texel without filter.
float visibility(vec3 at) {
    const vec2 texel =
        (at.xy - tick.map.opaque_lo) / (tick.map.opaque_hi - tick.map.opaque_lo) * float(tick.map.opaque_size);
    if (any(lessThan(texel, vec2(0))) || any(greaterThanEqual(texel, vec2(tick.map.opaque_size)))) return 1;
    return at.z >= texelFetch(opaque_shadow, ivec2(texel), 0).r ? 1 : 0;
}

// The mean of visibility() over the 5x5 texels around the point (percentage-closer filtering, seed 000 section 4.2.5).
float visibilitySoft(vec3 at) {
    const vec2 per_texel = (tick.map.opaque_hi - tick.map.opaque_lo) / float(tick.map.opaque_size);
    float lit = 0;
    for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x) lit += visibility(vec3(at.xy + vec2(x, y) * per_texel, at.z));
    return lit / 25;
}

// Visibility for surfaces: filtered over the four nearest texels; `bias` (m) moves the point toward the light.
float visibilityFiltered(vec3 at, float bias) {
    const vec2 texel =
        (at.xy - tick.map.opaque_lo) / (tick.map.opaque_hi - tick.map.opaque_lo) * float(tick.map.opaque_size) - 0.5;
    if (any(lessThan(texel, vec2(0))) || any(greaterThanEqual(texel, vec2(tick.map.opaque_size - 1)))) return 1;
    const ivec2 t = ivec2(texel);
    const vec2 f = texel - vec2(t);
    const float s = at.z + bias;
    const vec4 top = textureGather(opaque_shadow, (vec2(t) + 1) / float(tick.map.opaque_size)).wzxy;
    const vec4 lit = vec4(greaterThanEqual(vec4(s), top));
    return mix(mix(lit.x, lit.y, f.x), mix(lit.z, lit.w, f.x), f.y);
}
