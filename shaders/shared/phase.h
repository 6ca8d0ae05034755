// Phase functions, 1/sr. Directions are unit and along the photon's travel: `travel_in` before, `travel_out` after.
#ifndef BRUME_SHARED_PHASE_H
#define BRUME_SHARED_PHASE_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// Henyey-Greenstein, g in (-1, 1), g > 0 forward. Written with |in - out|^2 so that nothing cancels at the peak.
BRUME_FN real phaseHenyeyGreenstein(BRUME_VEC3 travel_in, BRUME_VEC3 travel_out, real g) {
    const real size = abs(g);
    const BRUME_VEC3 apart = travel_in - (g < real(0) ? -travel_out : travel_out);
    const real d = max((real(1) - size) * (real(1) - size) + size * dot(apart, apart), real(1e-20));
    return real(0.07957747154594767) * (real(1) - size) * (real(1) + size) / (d * sqrt(d));
}

// The medium's phase function: (1 - a) / 4 pi + a HG(g), anisotropy a in [0, 1].
BRUME_FN real phaseMixture(BRUME_VEC3 travel_in, BRUME_VEC3 travel_out, real anisotropy, real g) {
    return (real(1) - anisotropy) * real(0.07957747154594767) +
           anisotropy * phaseHenyeyGreenstein(travel_in, travel_out, g);
}

BRUME_PHYSICS_END

#endif
