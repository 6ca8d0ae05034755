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

// Draine (2003): Henyey-Greenstein times 1 + alpha cos^2, normalised; alpha >= 0. With alpha = 0 it is
// Henyey-Greenstein, with g = 0 and alpha = 1 Rayleigh. Mean cosine: g (1 + alpha (3 + 2 g^2) / 5) /
// (1 + alpha (1 + 2 g^2) / 3).
BRUME_FN real phaseDraine(BRUME_VEC3 travel_in, BRUME_VEC3 travel_out, real g, real alpha) {
    const real cosine = dot(travel_in, travel_out);
    return phaseHenyeyGreenstein(travel_in, travel_out, g) * (real(1) + alpha * cosine * cosine) /
           (real(1) + alpha * (real(1) + real(2) * g * g) / real(3));
}

// The medium's phase function: the part `part`, in [0, 1], by Draine, the rest by Henyey-Greenstein of asymmetry
// `second`. What media have which numbers: common/phase_lobes.h.
BRUME_FN real phaseOfLobes(BRUME_VEC3 travel_in, BRUME_VEC3 travel_out, real part, real g, real alpha, real second) {
    return (real(1) - part) * phaseHenyeyGreenstein(travel_in, travel_out, second) +
           part * phaseDraine(travel_in, travel_out, g, alpha);
}

// Schlick's approximation of Henyey-Greenstein, for comparison alone: Blasi, Le Saec, Schlick (1993) with
// k = 1.55 g - 0.55 g^3. It integrates to 1 for |k| < 1, and diverges for 0.938 < g < 1, where k > 1. Its mean cosine
// is 0.645 at g = 0.6.
BRUME_FN real phaseSchlick(BRUME_VEC3 travel_in, BRUME_VEC3 travel_out, real g) {
    const real k = real(1.55) * g - real(0.55) * g * g * g;
    const real d = real(1) - k * dot(travel_in, travel_out);
    return real(0.07957747154594767) * (real(1) - k * k) / (d * d);
}

BRUME_PHYSICS_END

#endif
