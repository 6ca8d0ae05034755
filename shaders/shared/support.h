// Support of a particle: the radius outside which its optical depth is negligible.
#ifndef BRUME_SHARED_SUPPORT_H
#define BRUME_SHARED_SUPPORT_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// Radius (m) outside which every line through a Gaussian of peak extinction `sigma_t` (1/m) and width `u` (m) has an
// optical depth below `cut` > 0: sigma_t u sqrt(pi/50) exp(-50 r^2/u^2) = cut. Negative when no line exceeds it.
BRUME_FN real supportRadius(real sigma_t, real u, real cut) {
    const real peak = sigma_t * u * real(0.25066282746310005);
    return peak > cut ? u * sqrt(log(peak / cut) * real(0.02)) : real(-1);
}

BRUME_PHYSICS_END

#endif
