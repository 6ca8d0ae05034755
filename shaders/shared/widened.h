// Gaussians that are widened along one axis, and cut by the ends of what is sampled.
#ifndef BRUME_SHARED_WIDENED_H
#define BRUME_SHARED_WIDENED_H

#include "erf.h"

BRUME_PHYSICS_BEGIN

// Part of a Gaussian of deviation `own` that lies between `lo` and `hi`, from its centre, over that of one of deviation
// `wide` > own, all in m. With that factor the wide one has as much mass between them. In [0, 4].
BRUME_FN real widenedShare(real own, real wide, real lo, real hi) {
    const real k = real(0.70710678118654752) / own, k_wide = real(0.70710678118654752) / wide;
    const real inside = erf(hi * k) - erf(lo * k), inside_wide = erf(hi * k_wide) - erf(lo * k_wide);
    return min(max(inside, real(0)) / max(inside_wide, real(1e-6)), real(4));
}

BRUME_PHYSICS_END

#endif
