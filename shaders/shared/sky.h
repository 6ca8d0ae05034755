// The sky: its radiance blends from the horizon's to the zenith's with the height of a direction.
#ifndef BRUME_SHARED_SKY_H
#define BRUME_SHARED_SKY_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// The zenith's part of the radiance in a unit direction of height `up` (y), in [0, 1]: a smooth step from -0.15 to
// 0.85.
BRUME_FN real skyZenithPart(real up) {
    const real x = min(max(up + real(0.15), real(0)), real(1));
    return x * x * (real(3) - real(2) * x);
}

// Irradiance over pi of a surface whose normal has height `up`, in [-1, 1], by the sky above the horizon: of one with a
// radiance of 1, and the zenith's part of it. The first is exact. The second is a fit to the integral of skyZenithPart
// times the cosine, within 0.0012 of at most 0.83.
BRUME_FN real skySeen(real up) { return real(0.5) + real(0.5) * up; }
BRUME_FN real skyZenithSeen(real up) {
    return (real(1) + up) * (real(0.28644) + up * (real(0.12781) + up * (real(-0.0402) + up * real(0.03931))));
}

BRUME_PHYSICS_END

#endif
