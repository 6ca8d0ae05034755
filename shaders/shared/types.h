// Structs that the CPU writes and shaders read: one text, compiled as C++ and as GLSL (scalar layout).
#ifndef BRUME_SHARED_TYPES_H
#define BRUME_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
namespace brume::gpu {
using uint = uint32_t;
using glm::ivec2;
using glm::mat3;
using glm::mat4;
using glm::uvec2;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
#endif

struct Particle {
    vec3 centre;   // m, world
    float scale;   // m, centre to vertex of its tetrahedron; u = scale * falloff
    vec3 albedo;   // rho
    float sigma_t; // 1/m, extinction at the centre
};

#ifdef __cplusplus
static_assert(sizeof(Particle) == 32 && offsetof(Particle, albedo) == 16 && offsetof(Particle, sigma_t) == 28);
} // namespace brume::gpu
#endif

#endif
