// What the method `tiles` keeps of a particle that one eye sees. CPU sizes buffers with it; layouts as in types.h.
#ifndef BRUME_SHARED_SPLAT_H
#define BRUME_SHARED_SPLAT_H

#ifdef __cplusplus
#include <cstddef>
#include <glm/glm.hpp>
namespace brume::gpu {
using uint = uint32_t;
using glm::uvec2;
using glm::vec2;
using glm::vec3;
#endif

// Light cached on a particle: T_L = transmittance + gradient . r + curvature k^2 r^2 at r from the centre.
struct ParticleLight {
    vec3 gradient;       // 1/m
    float transmittance; // kLookUp: such a fit is not enough, look the light up at every point
    float curvature;
};
const float kLookUp = 1e30f;

// Where a particle may be seen: directions whose distance to `direction`, both unit, is at most `chord`.
struct SplatCone {
    vec3 direction; // from the eye to the centre
    float chord;    // 2: everywhere, the eye is inside
};

// Functions that are affine in the pixel are three numbers: the value at pixel (0, 0), the steps to the right and down. d is the
// pixel's ray direction of unit view depth, c the centre relative to the eye.
struct Splat {
    vec3 across_x; // k (c x d) in two axes across c, times sqrt(log2 e): k^2 b^2 log2 e = (x^2 + y^2) / d^2
    vec2 across_y; // constant along a row: the value at pixel (0, 0), the step down
    vec3 along;    // c . d, m
    vec3 slope;    // gradient . d
    vec3 albedo;
    float light;     // mean on a line of transmittance + curvature (k^2 r^2 - k^2 b^2), less gradient . c; kLookUp as above
    float curvature; // as above
    float log_line;  // log2 of the optical depth of the line through the centre
    float k;         // 1/m
    float radius;    // m, of the support
    float nearest;   // m from the eye to the support; negative when the eye is inside
    float chord;     // of its cone
};

// The blocks of tiles of a picture, and when a ray ends.
struct SplatGrid {
    uvec2 blocks; // how many
    uvec2 block;  // pixels of one
    float least;  // transmittance below which a tile's rays end
};

#ifdef __cplusplus
static_assert(sizeof(ParticleLight) == 20 && sizeof(SplatCone) == 16 && sizeof(Splat) == 84);
} // namespace brume::gpu
#endif

#endif
