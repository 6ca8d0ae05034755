// A medium of tetrahedra: what its passes share, and integrals over an interval with linear extinction. One text,
// compiled as C++ and as GLSL (scalar layout).
#ifndef BRUME_SHARED_TETRAHEDRA_H
#define BRUME_SHARED_TETRAHEDRA_H

#include "real.h"
#include "types.h"

#ifdef __cplusplus
namespace brume::gpu {
using glm::uvec4;
#endif

const uint kNoTetrahedron = 0xffffffffu;

// Corners are indices of particles, whose extinctions and albedos are linear in between.
struct Tetrahedron {
    uvec4 corners;
    uvec4 neighbours; // [m]: the tetrahedron behind the face that corner m is not of, or kNoTetrahedron
};

// A face of the outside. Seen from there, its corners go round counterclockwise.
struct TetrahedraFace {
    uvec3 corners;
    uint cell; // index of its tetrahedron
};

// A band of rows of the volumetric shadow map.
struct TetrahedraBand {
    uint first_row, rows; // of texels
    uint layers;          // of four planes; the last plane of one is the first of the next
    uint faces;           // of the outside
};

#ifdef __cplusplus
static_assert(sizeof(Tetrahedron) == 32 && sizeof(TetrahedraFace) == 16 && sizeof(TetrahedraBand) == 16);
} // namespace brume::gpu
#endif

BRUME_PHYSICS_BEGIN

// Optical depth of an interval of `length` m, where the extinction is linear from a to b, 1/m.
BRUME_FN real linearDepth(real a, real b, real length) { return real(0.5) * (a + b) * length; }

// The part of such an interval's length at which the part s of its optical depth is reached, all in [0, 1]. It solves
// a x + (b - a) x^2 / 2 = s (a + b) / 2, in a form without cancellation. Where there is no extinction it is s.
BRUME_FN real linearQuantile(real a, real b, real s) {
    const real sum = a + b;
    const real p = sum > real(0) ? a / sum : real(0.5);
    const real q = sum > real(0) ? b / sum : real(0.5);
    return min(s / max(p + sqrt(p * p * (real(1) - s) + q * q * s), real(1e-30)), real(1));
}

BRUME_PHYSICS_END

#endif
