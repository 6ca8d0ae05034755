// The union of balls on a ray toward the sun. Include after `uint union_bits[]`, which union_bins.comp has
// written for this tick.
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/interval_set.h"

struct UnionRay {
    float path;   // m, length of its parts within balls
    uint hits;    // places where it enters a ball or leaves one
    uint nearest; // index of the ball that it meets first; kNoUnionBall: it meets none
};
const uint kNoUnionBall = 0xffffffffu;

// From x on.
UnionRay unionRay(vec3 x) {
    const UnionBalls balls = tick.balls;
    const vec3 toward = tick.sun.to_light;
    IntervalSet parts;
    parts.count = 0;
    parts.fused = 0;
    UnionRay ray = UnionRay(0, 0, kNoUnionBall);
    float first = 1e30;
    const vec2 at = (vec2(dot(tick.map.x, x), dot(tick.map.y, x)) - balls.lo) / balls.cell;
    if (any(lessThan(at, vec2(0))) || any(greaterThanEqual(at, vec2(balls.side)))) return ray;
    const uint cell = (uint(at.y) * balls.side + uint(at.x)) * balls.words;
    for (uint word = 0; word < balls.words; ++word)
        for (uint bits = union_bits[cell + word]; bits != 0; bits &= bits - 1) {
            const uint i = 32 * word + findLSB(bits);
            const vec3 from = particles[i].centre - x;
            const float radius = balls.radius * particles[i].scale, closest = dot(from, toward);
            const vec3 off = from - closest * toward; // never |from|^2 - closest^2
            const float half2 = radius * radius - dot(off, off);
            const float half_chord = sqrt(max(half2, 0)), end = closest + half_chord;
            if (!(half2 > 0 && end > 0)) continue;
            const float enters = closest - half_chord, begin = max(enters, 0);
            ray.hits += enters > 0 ? 2 : 1;
            if (begin < first) {
                first = begin;
                ray.nearest = i;
            }
            addInterval(parts, begin, end);
        }
    ray.path = lengthOf(parts);
    return ray;
}
