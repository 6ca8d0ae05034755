// A rotation by chance for each particle, the same in every shader and in tests. Compiled as C++ and as GLSL.
#ifndef BRUME_SHARED_ORIENTATION_H
#define BRUME_SHARED_ORIENTATION_H

#ifdef __cplusplus
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
namespace brume::gpu {
using uint = uint32_t;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using std::sqrt;
#define BRUME_INLINE inline
#define BRUME_PRECISE
#else
#define BRUME_INLINE
#define BRUME_PRECISE precise // arithmetic as it is written: the same bits in all kinds of shaders
#endif

// The same three numbers in [0, 1) for the same `v`: Jarzynski and Olano, Hash Functions for GPU Rendering, 2020
// (pcg3d).
BRUME_INLINE vec3 hashed(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    for (int i = 0; i < 2; ++i) {
        v.x += v.y * v.z; // one after another: together they are not even
        v.y += v.z * v.x;
        v.z += v.x * v.y;
        if (i == 0) v ^= v >> 16u;
    }
    return vec3(v >> 8u) / 16777216.0f;
}

// A point of the unit disc, evenly by chance, without its middle. The tries end: 1 in 10^10 has none.
BRUME_INLINE vec2 hashedInDisc(uint number, uint which) {
    vec2 at = vec2(0.5f, 0.5f);
    for (uint i = 0u; i < 15u; ++i) {
        const vec3 some = hashed(uvec3(number, which, i));
        at = 2.0f * vec2(some.x, some.y) - 1.0f;
        BRUME_PRECISE const float square = dot(at, at);
        if (square < 1.0f && square > 1e-6f) return at;
    }
    return vec2(0.5f, 0.5f);
}

// A unit quaternion (x, y, z, w), evenly by chance among all rotations (Marsaglia 1972).
BRUME_INLINE vec4 orientationOf(uint particle) {
    const vec2 a = hashedInDisc(particle, 0u), b = hashedInDisc(particle, 1u);
    BRUME_PRECISE const float rest = sqrt((1.0f - dot(a, a)) / dot(b, b));
    BRUME_PRECISE const vec4 q = vec4(a.x, a.y, b.x * rest, b.y * rest);
    return q;
}

BRUME_INLINE vec3 turned(vec4 q, vec3 v) {
    const vec3 axis = vec3(q.x, q.y, q.z);
    BRUME_PRECISE const vec3 moved = v + 2.0f * cross(axis, cross(axis, v) + q.w * v);
    return moved;
}
BRUME_INLINE vec3 turnedBack(vec4 q, vec3 v) { return turned(vec4(-q.x, -q.y, -q.z, q.w), v); }

#ifdef __cplusplus
} // namespace brume::gpu
#endif
#undef BRUME_INLINE
#undef BRUME_PRECISE
#endif
