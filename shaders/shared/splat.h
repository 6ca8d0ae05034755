// Structs of method `tiles` for the particles that one eye sees. C++ uses their sizes; layouts as in types.h.
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
    float transmittance; // kLookUp: the fit is not enough, light is looked up at every point
    float curvature;
};
const float kLookUp = 1e30f;

// Directions in which a particle may be seen: unit directions whose distance to `direction` is at most `chord`.
struct SplatCone {
    vec3 direction; // from the eye to the centre
    float chord;    // 2: all directions, since the eye is inside
};

// A particle as functions of the pixel. An affine function is three numbers: its value at pixel (0, 0), its steps to
// the right and down. d: the pixel's ray direction of unit view depth; c: the centre relative to the eye. Of an
// ellipsoid both are in units of its semi-axes, but for `slope`.
struct Splat {
    vec3 across_x; // k (c x d) in two axes across c, times sqrt(log2 e): k^2 b^2 log2 e = (x^2 + y^2) / d^2
    vec2 across_y; // constant along a row: the value at pixel (0, 0), the step down
    vec3 along;    // c . d, m
    vec3 slope;    // gradient . d
    vec3 albedo;
    float light;     // line mean of transmittance + curvature (k^2 r^2 - k^2 b^2), less gradient . c; or kLookUp
    float curvature; // as above
    float log_line;  // log2 of the optical depth of the line through the centre
    float k;         // 1/m
    float radius;    // m, of the support
    float nearest;   // m from the eye to the support; negative if the eye is inside
    float chord;     // of its cone
};

// The ray's direction of unit view depth in units of an ellipsoid's semi-axes (ellipsoid.h): three affine functions.
struct SplatWay {
    vec3 a, b, c;
};

// Blocks of tiles of a picture, and the transmittance at which rays end.
struct SplatGrid {
    uvec2 blocks; // number of blocks
    uvec2 block;  // pixels of a block
    float least;  // transmittance below which the rays of a tile end
};

#ifdef __cplusplus
static_assert(sizeof(ParticleLight) == 20 && sizeof(SplatCone) == 16 && sizeof(Splat) == 84 && sizeof(SplatWay) == 36);
} // namespace brume::gpu
#endif

#endif
