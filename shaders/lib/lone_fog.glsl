// A medium that is one fog: its light has a closed form. Include after the eye is declared.
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/fog.glsl"

// True: the medium is one fog, whose light has a closed form.
bool isFogOnly() { return kHasFog && isLoneFog() && tick.particle_count == 0; }

// With isFogOnly(): its light of the sun between two view depths, for E = 1 and without its phase function.
vec3 lightOfLoneFog(vec3 dir, vec2 range) {
    const float metres = length(dir);
    FogPart part = partInFog(0, eye.position, dir, range.x, range.y);
    if (!(part.end > part.begin)) return vec3(0);
    part.end = seenEnd(0, eye.position, dir, metres, part); // depths stay finite, and their differences right
    const float before = fogBetween(eye.position, dir, metres, eye.near_depth, part.begin);
    const float own = depthInFog(0, eye.position, dir, metres, part);
    const float toward_begin = fogTowardSun(eye.position + part.begin * dir);
    const float toward_end = fogTowardSun(eye.position + part.end * dir);
    return tick.fogs[0].albedo * scatterOwn(own, before + toward_begin, before + own + toward_end);
}
