// Thin flat sheets of glass: where a ray meets one, what it mirrors and what passes, and how the layers of medium
// between sheets add up.
//
// C_i, T_i: the medium's scattered radiance and transmittance from the eye to the i-th nearest sheet on a ray; C, T:
// those of the whole ray; B: what is behind. A sheet mirrors the part F_i of the sky's radiance r_i, and lets t_i pass.
// With W_i = t_1 ... t_i, the picture of n sheets is the sum over i of (W_(i-1) - W_i) C_i + W_(i-1) F_i T_i r_i, and
// of W_n (C + T B). That is the light of each layer, W_(i-1) (C_i - C_(i-1)), with equal C_i taken together. So nothing
// cancels, and no layer is divided by what is in front of it.
#ifndef BRUME_SHARED_GLASS_H
#define BRUME_SHARED_GLASS_H

#include "real.h"

#ifdef __cplusplus
#include <cstdint>
namespace brume::gpu {
using uint = uint32_t;
using glm::vec3;
#endif

const uint kMostGlasses = 16u;
const uint kGlassLayers = 4u; // sheets on a ray that are drawn: the nearest ones

struct GlassSheet {
    vec3 centre;        // m
    float reflectance;  // straight on
    vec3 across;        // unit / half of its width: 1/m
    vec3 along;         // unit / half of its height
    vec3 normal;        // unit
    vec3 transmittance; // of what is not mirrored
};

// What glass.comp does with a pixel.
struct GlassPush {
    uint sheets;     // number of them
    uint drawn;      // what the target holds: 0: the whole medium before surfaces; i: up to the i-th sheet
    uint layers;     // the last layer
    uint first, end; // rows of pixels
};

#ifdef __cplusplus
static_assert(sizeof(GlassSheet) == 64 && sizeof(GlassPush) == 20);
} // namespace brume::gpu
#endif

BRUME_PHYSICS_BEGIN

// Number t for which origin + t * dir lies on a sheet, or -1 if there is none: behind the origin too, and of rays that
// are parallel to the sheet. `offset`: the sheet's centre less the origin; across, along, normal: as in GlassSheet.
BRUME_FN real glassAt(BRUME_VEC3 offset, BRUME_VEC3 across, BRUME_VEC3 along, BRUME_VEC3 normal, BRUME_VEC3 dir) {
    const real falls = dot(dir, normal), height = dot(offset, normal);
    if (!(abs(falls) > real(1e-20)) || !(height / falls > real(0))) return real(-1);
    const real t = height / falls;
    const BRUME_VEC3 at = t * dir - offset;
    return max(abs(dot(at, across)), abs(dot(at, along))) <= real(1) ? t : real(-1);
}

// Part that a sheet mirrors at this cosine to its normal (Schlick 1994); `straight`: straight on. 0: it mirrors nothing
// at any angle.
BRUME_FN real glassMirrors(real straight, real cosine) {
    const real grazing = min(max(real(1) - abs(cosine), real(0)), real(1)), square = grazing * grazing;
    return straight > real(0) ? straight + (real(1) - straight) * square * square * grazing : real(0);
}

BRUME_PHYSICS_END

#endif
