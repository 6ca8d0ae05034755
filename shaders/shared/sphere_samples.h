// Samples of a quantity in spheres, and what they say of it at a place: a mean of their values, or of the planes
// through these (Ren, Zhou, Lin, Guo, Gradient-based Interpolation and Sampling for Real-time Rendering of
// Inhomogeneous, Single-scattering Media, 2008).
#ifndef BRUME_SHARED_SPHERE_SAMPLES_H
#define BRUME_SHARED_SPHERE_SAMPLES_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// The weight of a sample at a place whose distance from it is a part `q` of its radius. 0 from q = 1 on.
// printed: R/r, as in the paper, which is 1 at the rim and has no bound at the sample (here 1e6). Otherwise a Gaussian,
// exp(-9/2 q^2), which is 0.011 at the rim.
BRUME_FN real sampleWeight(real q, bool printed) {
    if (!(q < real(1))) return real(0);
    return printed ? real(1) / max(q, real(1e-6)) : exp(real(-4.5) * q * q);
}

// The local shading error of a sample as printed (section 5, equation 5), up to a factor that is the same for all.
// radius: of its sphere, in any unit that all share. errors: mean over the places that are tested of the error of the
// light, times the density there. through: transmittance from the sphere to the eye.
BRUME_FN real shadingError(real radius, real errors, real through) {
    return radius * radius * radius * errors * through;
}

BRUME_PHYSICS_END

#endif
