// Gaussian particles with three axes. The extinction of one is sigma_t exp(-k^2 |y|^2), k = gaussianK(scale, falloff),
// where y is the place from the centre in units of the particle's semi-axes a, b, c. These are orthogonal, the longest
// has the length 1, and none is shorter than kLeastAxis. Without them a particle is a ball: y is the place itself, m.
#ifndef BRUME_SHARED_ELLIPSOID_H
#define BRUME_SHARED_ELLIPSOID_H

#include "real.h"

#ifdef __cplusplus
namespace brume::gpu {
inline constexpr float kLeastAxis = 0.01f;
} // namespace brume::gpu
#else
const float kLeastAxis = 0.01;
#endif

BRUME_PHYSICS_BEGIN

// Coordinates of a vector in units of the semi-axes.
BRUME_FN BRUME_VEC3 inSemiAxes(BRUME_VEC3 x, BRUME_VEC3 a, BRUME_VEC3 b, BRUME_VEC3 c) {
    return BRUME_VEC3(dot(a, x) / dot(a, a), dot(b, x) / dot(b, b), dot(c, x) / dot(c, c));
}

// A ball that has an ellipsoid's extinction at all points of one line.
BRUME_STRUCT BallOnLine {
    real k;       // 1/m
    real closest; // m along the line, of the closest approach to its centre
    real b2;      // m^2, squared distance there
};

// to: from the line's point 0 to the centre, m. w: the line's unit direction. k: that of the longest semi-axis, 1/m.
BRUME_FN BRUME_OF(BallOnLine)
    ballOnLine(BRUME_VEC3 to, BRUME_VEC3 w, real k, BRUME_VEC3 a, BRUME_VEC3 b, BRUME_VEC3 c) {
    const BRUME_VEC3 way = inSemiAxes(w, a, b, c);
    const BRUME_VEC3 centre = inSemiAxes(to, a, b, c);
    const real squared = dot(way, way); // at least 1: no axis is longer
    BRUME_OF(BallOnLine) ball;
    ball.closest = dot(centre, way) / squared;
    const BRUME_VEC3 off = centre - ball.closest * way;
    ball.k = k * sqrt(squared);
    ball.b2 = dot(off, off) / squared;
    return ball;
}

// A Gaussian as planes across an axis z cut it. Its variances across are those of its sum along z. At a place (x, y)
// its middle along z is tilt_x x + tilt_y y, where its variance is `along`.
BRUME_STRUCT SlicedGaussian {
    real xx, xy, yy;
    real tilt_x, tilt_y;
    real along;
};

// Of an ellipsoid; all axes are those of the planes. s: standard deviation along the longest semi-axis.
BRUME_FN BRUME_OF(SlicedGaussian) slicedGaussian(real s, BRUME_VEC3 a, BRUME_VEC3 b, BRUME_VEC3 c) {
    const real pa = real(1) / (dot(a, a) * dot(a, a));
    const real pb = real(1) / (dot(b, b) * dot(b, b));
    const real pc = real(1) / (dot(c, c) * dot(c, c));
    const real zz = pa * a.z * a.z + pb * b.z * b.z + pc * c.z * c.z; // inverse of the variance at fixed x and y
    BRUME_OF(SlicedGaussian) cut;
    cut.xx = s * s * (a.x * a.x + b.x * b.x + c.x * c.x);
    cut.xy = s * s * (a.x * a.y + b.x * b.y + c.x * c.y);
    cut.yy = s * s * (a.y * a.y + b.y * b.y + c.y * c.y);
    cut.tilt_x = -(pa * a.x * a.z + pb * b.x * b.z + pc * c.x * c.z) / zz;
    cut.tilt_y = -(pa * a.y * a.z + pb * b.y * b.z + pc * c.y * c.z) / zz;
    cut.along = s * s / zz;
    return cut;
}

// Determinant of the variances across: the product of the largest and the least, m^4.
BRUME_FN real acrossDeterminant(BRUME_OF(SlicedGaussian) cut) {
    return max(cut.xx * cut.yy - cut.xy * cut.xy, real(1e-7) * cut.xx * cut.yy);
}

// Variance along z of the whole Gaussian.
BRUME_FN real varianceAlong(BRUME_OF(SlicedGaussian) cut) {
    return cut.along + cut.tilt_x * (cut.xx * cut.tilt_x + real(2) * cut.xy * cut.tilt_y) +
           cut.yy * cut.tilt_y * cut.tilt_y;
}

// The Gaussian blurred across, just enough that no direction across has a variance below `least`. Its mass is kept if
// its peak is multiplied by the square root of both determinants' ratio and of both variances along.
BRUME_FN BRUME_OF(SlicedGaussian) widenedAcross(BRUME_OF(SlicedGaussian) cut, real least) {
    const real middle = real(0.5) * (cut.xx + cut.yy);
    const real half_gap = real(0.5) * (cut.xx - cut.yy);
    const real reach = sqrt(half_gap * half_gap + cut.xy * cut.xy);
    const real most = middle + reach;
    const real fewest = acrossDeterminant(cut) / max(most, real(1e-30));
    if (fewest >= least) return cut;
    // Unit direction (u, v) of the larger variance.
    real u = half_gap >= real(0) ? reach + half_gap : cut.xy;
    real v = half_gap >= real(0) ? cut.xy : reach - half_gap;
    const real size = sqrt(u * u + v * v);
    u = size > real(0) ? u / size : real(1);
    v = size > real(0) ? v / size : real(0);
    const real first = max(most, least), second = least;
    const real tilt_first = cut.tilt_x * u + cut.tilt_y * v, tilt_second = cut.tilt_y * u - cut.tilt_x * v;
    const real part_first = most / first, part_second = fewest / second;
    BRUME_OF(SlicedGaussian) wide;
    wide.xx = first * u * u + second * v * v;
    wide.xy = (first - second) * u * v;
    wide.yy = first * v * v + second * u * u;
    wide.tilt_x = part_first * tilt_first * u - part_second * tilt_second * v;
    wide.tilt_y = part_first * tilt_first * v + part_second * tilt_second * u;
    wide.along = cut.along + most * tilt_first * tilt_first * (real(1) - part_first) +
                 fewest * tilt_second * tilt_second * (real(1) - part_second);
    return wide;
}

BRUME_PHYSICS_END

#endif
