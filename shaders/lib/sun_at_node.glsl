// The sun's light at a node of `push.lit`. Include after lib/light.glsl, lib/fog.glsl and lib/occluded.glsl.
#include "shaders/blocks/tick.glsl"

const float kFarAway = 1e6;  // m, where the sun's rays are taken to begin
const float kSunApart = 0.5; // spacings: the sun is looked for from so far around a node, four times

// The part of the sun's light that arrives at x. Four rays around it smooth shadows' edges, as nodes apart do.
float sunAt(vec3 x) {
    const float toward = lightDepthAnywhere(toShadowVolume(x)) + (kHasFog ? fogTowardSun(x) : 0);
    if (!(toward < 30)) return 0;
    float seen = 1;
    if (kHasCasters) {
        seen = 0;
        [[dont_unroll]] for (uint i = 0; i < 4; ++i) { // corners of a tetrahedron
            const vec3 corner = vec3(i < 2 ? 1 : -1, i == 0 || i == 3 ? 1 : -1, (i & 1) == 0 ? 1 : -1);
            const vec3 from = x + 0.5 * kSunApart * push.lit.spacing * corner;
            seen += isOccluded(from, kFarAway * tick.sun.to_light, true) ? 0 : 0.25;
        }
    }
    return seen * exp(-toward);
}
