// A cheap approximation of the sRGB curve (IEC 61966-2-1).
#ifndef BRUME_SHARED_SRGB_H
#define BRUME_SHARED_SRGB_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// 12.92 x up to 0.0031308; above it 1.055 x^(1/2.4) - 0.055, as a quotient of polynomials that errs by at most
// 1.2e-4, 0.03 of one of 255 levels: a power takes four times as long on a CPU. x in [0, 1].
BRUME_FN real srgb(real x) {
    const real p =
        real(-0.011012582) +
        x * (real(20.772774915) + x * (real(1067.09493023) + x * (real(4314.56874285) + x * real(860.629396069))));
    const real q = real(1) + x * (real(180.989206269) + x * (real(2653.83543786) + x * real(3426.49125758)));
    return x > real(0.0031308) ? p / q : real(12.92) * x;
}

BRUME_PHYSICS_END

#endif
