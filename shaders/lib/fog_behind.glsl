// Fog on the rest of a ray, behind the slices that are marched. Include after lib/fog.glsl, `eye` and kHasAmbient.
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/phase.h"

// Light of the sun and of fog itself behind `begin`, without shadows of objects and particles. Of several fogs
// the sun is dimmed as there.
vec3 fogBehind(vec3 dir, float begin, float end, inout float depth) {
    const float metres = length(dir);
    float shares[kMostFogs];
    const float own = fogShares(eye.position, dir, metres, begin, end, shares);
    const vec3 from = eye.position + begin * dir;
    const float toward = fogTowardSun(from);
    vec3 sum = vec3(0);
    [[dont_unroll]] for (uint i = 0; i < tick.fog_count; ++i) {
        const Phase p = tick.fogs[i].phase;
        const float phase = phaseOfLobes(-tick.sun.to_light, -dir / metres, p.part, p.asymmetry, p.draine, p.second);
        float lit = shares[i] * exp(-toward);
        if (isLoneFog()) {
            FogPart part = partInFog(0, eye.position, dir, begin, end);
            part.end = seenEnd(0, eye.position, dir, metres, part);
            const float lone = part.end > part.begin ? depthInFog(0, eye.position, dir, metres, part) : 0;
            lit = scatterOwn(lone, toward, lone + fogTowardSun(eye.position + part.end * dir));
        }
        sum += tick.fogs[i].albedo * (tick.sun.irradiance * phase * lit);
        if (kHasAmbient) sum += tick.fogs[i].albedo * tick.ambient * shares[i];
        if (kHasGlow) sum += tick.fogs[i].emission * shares[i];
    }
    sum *= exp(-depth);
    depth += own;
    return sum;
}
