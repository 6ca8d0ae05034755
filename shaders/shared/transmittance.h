// Optical depth of one Gaussian particle, and exponentials without cancellation. Metres; extinction in 1/m.
// The extinction is sigma(x) = sigma_t exp(-k^2 |x - c|^2), k = sqrt(50) / u, u = scale * falloff; sigma_t: its peak.
#ifndef BRUME_SHARED_TRANSMITTANCE_H
#define BRUME_SHARED_TRANSMITTANCE_H

#include "erf.h"

BRUME_PHYSICS_BEGIN

// Taylor series of (1 - e^-x) / x; relative error 5e-8 at |x| = 1/4, where callers switch to the plain form.
BRUME_FN real phiSeries(real x) {
    return real(1) -
           x * (real(1.0 / 2.0) -
                x * (real(1.0 / 6.0) - x * (real(1.0 / 24.0) - x * (real(1.0 / 120.0) - x * real(1.0 / 720.0)))));
}

// phi(x) = (1 - e^-x) / x; phi(0) = 1.
BRUME_FN real phi(real x) {
    const bool small = abs(x) < real(0.25);
    const real plain = (real(1) - exp(-x)) / (small ? real(1) : x);
    return small ? phiSeries(x) : plain;
}

// 1 - e^-x for x >= 0: the opacity of optical depth x.
BRUME_FN real opacity(real x) {
    const real series = x * phiSeries(x);
    return x < real(0.25) ? series : real(1) - exp(-x);
}

// -log(1 - y) for y in [0, 1): the optical depth of opacity y; 85 for y = 1.
BRUME_FN real depthOfOpacity(real y) {
    const real z = y / (real(2) - y);
    const real z2 = z * z;
    const real series =
        real(2) * z * (real(1) + z2 * (real(1.0 / 3.0) + z2 * (real(1.0 / 5.0) + z2 * real(1.0 / 7.0))));
    return y < real(0.25) ? series : -log(max(real(1) - y, real(1e-37)));
}

// The constant of the particle: k = sqrt(50) / (scale * falloff), 1/m.
BRUME_FN real gaussianK(real scale, real falloff) {
    return real(7.0710678118654755) / max(scale * falloff, real(1e-18));
}

// exp(-k^2 b^2): the part of the peak on a line that passes the centre at distance b (b2 = b^2, m^2).
BRUME_FN real gaussianAcross(real k, real b2) { return exp(-(k * b2) * k); }

// Optical depth of the whole line; across = gaussianAcross(k, b2).
BRUME_FN real lineDepth(real sigma_t, real k, real across) {
    return min(real(1.7724538509055159) * (min(sigma_t, real(1e30)) * across) / max(k, real(1e-20)), real(1e30));
}

// Optical depth on the half line from a point toward the light; ks = k * (coordinate of the point along to_light,
// relative to the centre, m), positive if the point is nearer to the light than the centre.
BRUME_FN real lightDepth(real sigma_t, real k, real across, real ks) {
    return real(0.5) * lineDepth(sigma_t, k, across) * erfc(ks);
}

// One particle on one segment of a ray. o = entry - centre, w = the ray's unit direction, L = length (m):
// a = k (o . w), h = k L, b2 = |o x w|^2.
BRUME_STRUCT GaussianSegment {
    real k;              // 1/m, > 0
    real a, h;           // entry and length in units of 1/k; 0 is the closest approach to the centre
    real tail_a, tail_c; // erfc(|a|), erfc(|a + h|)
    real peak;           // 1/m, extinction at the closest approach
    real line;           // optical depth of the whole line
    real depth;          // optical depth of the segment
};

// A segment from the optical depth of its whole line.
BRUME_FN BRUME_OF(GaussianSegment) segmentOfLine(real line, real k, real a, real h) {
    BRUME_OF(GaussianSegment) segment;
    segment.k = max(k, real(1e-20));
    segment.a = clamp(a, real(-1e9), real(1e9));
    segment.h = clamp(h, real(0), real(2e9));
    segment.tail_a = erfcAbs(segment.a);
    segment.tail_c = erfcAbs(segment.a + segment.h);
    segment.peak = min(line * segment.k * real(0.5641895835477563), real(1e30));
    segment.line = line;
    segment.depth = real(0.5) * line * erfDifference(segment.a, segment.h, segment.tail_a, segment.tail_c);
    return segment;
}

BRUME_FN BRUME_OF(GaussianSegment) gaussianSegment(real sigma_t, real k, real b2, real a, real h) {
    const real across = gaussianAcross(k, b2);
    BRUME_OF(GaussianSegment) segment = segmentOfLine(lineDepth(sigma_t, k, across), k, a, h);
    segment.peak = min(sigma_t, real(1e30)) * across;
    return segment;
}

// Optical depth of one particle on a segment.
BRUME_FN real segmentDepth(real sigma_t, real k, real b2, real a, real h) {
    return real(0.5) * lineDepth(sigma_t, k, gaussianAcross(k, b2)) * erfDifference(a, h);
}

BRUME_PHYSICS_END

#endif
