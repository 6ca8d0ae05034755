// The error function and its relatives for Gaussians on rays, safe in float: finite for every finite or infinite
// argument. Branches are selects over cheap expressions, because SIMD lanes pay for both sides anyway.
#ifndef BRUME_SHARED_ERF_H
#define BRUME_SHARED_ERF_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// e^(x^2) erfc(x) for x >= 0: a polynomial in s = (x - 2.5) / (x + 2.5), relative error 1.8e-7 by itself,
// 4.3e-7 measured in float. x above 1e30 counts as 1e30.
BRUME_FN real erfcx(real x) {
    const real y = min(x, real(1e30));
    const real t = real(1) / (y + real(2.5));
    const real s = (y - real(2.5)) * t;
    real p = real(0.000490755483);
    p = p * s + real(-0.000354440795);
    p = p * s + real(-0.0046576825);
    p = p * s + real(0.0083398493);
    p = p * s + real(0.0283104237);
    p = p * s + real(-0.171237946);
    p = p * s + real(0.453919739);
    p = p * s + real(-0.80465275);
    p = p * s + real(1.05403173);
    return p * t;
}

// erfc(|x|), relative error growing as x^2 epsilon; 0 beyond about 9.2 in float.
BRUME_FN real erfcAbs(real x) { return exp(-x * x) * erfcx(abs(x)); }

BRUME_FN real erfc(real x) {
    const real tail = erfcAbs(x);
    return x < real(0) ? real(2) - tail : tail;
}

BRUME_FN real erf(real x) {
    const real tail = real(1) - erfcAbs(x);
    const real y = min(x * x, real(1));
    const real series =
        real(1) - y * (real(1.0 / 3.0) -
                       y * (real(0.1) - y * (real(1.0 / 42.0) - y * (real(1.0 / 216.0) - y * real(1.0 / 1320.0)))));
    return y < real(0.25) ? real(1.1283791670955126) * x * series : (x < real(0) ? -tail : tail);
}

// erf(c) - erf(a) for a <= c from their tails erfcAbs(a), erfcAbs(c): never the difference of two erf of like sign.
// The error is relative to the larger tail: for small c - a use erfDifference.
BRUME_FN real erfBetween(real a, real tail_a, real c, real tail_c) {
    const real straddle = real(2) - tail_a - tail_c;
    return max(a < real(0) && c > real(0) ? straddle : abs(tail_a - tail_c), real(0));
}

// erf(a + h) - erf(a) for any h >= 0; m = a + h/2. If h and m h are small: Taylor series about the middle, whose
// terms in s = (m h)^2 and h^2 stay finite for any m.
BRUME_FN real erfDifference(real a, real h, real tail_a, real tail_c) {
    const real m = a + real(0.5) * h;
    const real s = (m * h) * (m * h);
    const real r = h * h;
    const real second = (real(2) * s - r) * real(1.0 / 12.0);
    const real fourth = (s * (real(4) * s - real(12) * r) + real(3) * r * r) * real(1.0 / 480.0);
    const real sixth =
        (s * (s * (s - real(7.5) * r) + real(11.25) * r * r) - real(1.875) * r * r * r) * real(1.0 / 5040.0);
    const real series = real(1.1283791670955126) * h * exp(-m * m) * (real(1) + (second + (fourth + sixth)));
    const real wide = erfBetween(a, tail_a, a + h, tail_c);
    return h < real(0.5) && s < real(0.5) ? series : wide;
}

BRUME_FN real erfDifference(real a, real h) {
    const real near = clamp(a, real(-1e9), real(1e9));
    const real length = clamp(h, real(0), real(2e9));
    return erfDifference(near, length, erfcAbs(near), erfcAbs(near + length));
}

// Differences of erf over neighbouring intervals of one length, one after the other by two multiplications each.
BRUME_STRUCT ErfSteps {
    real value;  // difference over this interval
    real ratio;  // the next interval's difference over this one's
    real change; // the next interval's ratio over this one's
};

// Steps of length h > 0; the first is from u - h/2 to u + h/2. A difference is that of a Gaussian which has the
// interval's variance besides: both agree in their first three moments. For h <= 1 a value, and the sum of neighbouring
// ones, errs by at most 3.7e-3 h^4. `u` in [-5, 5].
BRUME_FN BRUME_OF(ErfSteps) erfSteps(real u, real h) {
    const real narrowed = real(1) / (real(1) + h * h * real(1.0 / 6.0));
    BRUME_OF(ErfSteps) steps;
    steps.value = real(1.1283791670955126) * h * sqrt(narrowed) * exp(-narrowed * u * u);
    steps.ratio = exp(-narrowed * h * (real(2) * u + h));
    steps.change = exp(real(-2) * narrowed * h * h);
    return steps;
}

// q >= 0 with erfc(q) = y, for y in [0, 1]; y below 1e-37 counts as 1e-37 (q = 9.1). Absolute error 3e-7 and rounding.
BRUME_FN real erfcInverse(real y) {
    const real t = sqrt(-log(real(0.5) * max(y, real(1e-37))));
    const real p =
        real(-2.19187404458) +
        t * (real(-5.86487963478) + t * (real(4.61009052695) + t * (real(6.02925898287) + t * real(0.832248362454))));
    const real q = real(1) + t * (real(6.42974035556) + t * (real(6.04842249221) + t * real(0.83199420457)));
    return max(p / q, real(0));
}

BRUME_PHYSICS_END

#endif
