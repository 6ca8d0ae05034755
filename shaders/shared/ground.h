// The structure of a ground: a sum f(x, z) of plane waves over a horizontal plane, and its mean over a pixel in closed
// form. The mean of a wave of wave vector k over a Gaussian footprint with half axes a and b is the wave at its centre
// times exp(-((k.a)^2 + (k.b)^2) / 2).
#ifndef BRUME_SHARED_GROUND_H
#define BRUME_SHARED_GROUND_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// Half an axis of a pixel's footprint on a horizontal plane, m; y = 0. `depth * dir` leads from the eye to the plane,
// `step` is the change of dir to the next pixel. Where the plane is seen at a flat angle, the axis is long along the
// view. Beyond 1000 km and below 1e-6 of slope it grows no more: it is far longer than any wave, and finite.
BRUME_FN BRUME_VEC3 groundFootprint(BRUME_VEC3 dir, BRUME_VEC3 step, real depth) {
    const BRUME_VEC3 moved = step - dir * (step.y / min(dir.y, real(-1e-6)));
    const real half_depth = real(0.5) * min(depth, real(1e6));
    return BRUME_VEC3(half_depth * moved.x, real(0), half_depth * moved.z);
}

// cos(2 pi turns), within 1.3e-6.
BRUME_FN real groundCosine(real turns) {
    const real w = real(0.25) - abs(turns - floor(turns + real(0.5))), s = w * w; // it is sin(2 pi w)
    return w * (real(6.2831805) + s * (real(-41.339246) + s * (real(81.408007) - s * real(71.60768))));
}

// The mean of a wave that has m turns along x and n along z in a period, around (x, z). All lengths are in periods.
BRUME_FN real groundWave(real m, real n, real phase, real x, real z, BRUME_VEC3 a, BRUME_VEC3 b) {
    const real of_a = m * a.x + n * a.z, of_b = m * b.x + n * b.z;
    return groundCosine(m * x + n * z + phase) * exp(real(-19.739209) * (of_a * of_a + of_b * of_b)); // (2 pi)^2 / 2
}

// The mean of f around (x, z), over the footprint with half axes a and b. `size`: m, length of the longest wave.
// |f| <= 1, and its root mean square over the plane is 0.17.
//
// Five octaves of four waves each. An octave is the one before, turned by atan(1/2), shorter by sqrt(5) and weaker by
// 3/4: its places are those of the one before times 2 + i, as complex numbers. Every wave has whole numbers of turns
// along the sides of a square of 64 * size. So f has that period, and far away it loses only what places lose in float.
BRUME_FN real groundStructure(real x, real z, BRUME_VEC3 a, BRUME_VEC3 b, real size) {
    const real per_metre = real(0.015625) / size; // 1 / 64
    x *= per_metre;
    z *= per_metre;
    x -= floor(x);
    z -= floor(z);
    a *= per_metre;
    b *= per_metre;
    real sum = real(0), part = real(0.081946); // all parts together: 1
    for (int octave = 0; octave < 5; ++octave) {
        sum += part * (groundWave(real(63), real(9), real(0.13), x, z, a, b) +
                       groundWave(real(-12), real(78), real(0.37), x, z, a, b) +
                       groundWave(real(-75), real(60), real(0.92), x, z, a, b) +
                       groundWave(real(72), real(92), real(0.71), x, z, a, b));
        const real turned = real(2) * x - z + real(0.37);
        z = x + real(2) * z + real(0.61);
        x = turned;
        a = BRUME_VEC3(real(2) * a.x - a.z, real(0), a.x + real(2) * a.z);
        b = BRUME_VEC3(real(2) * b.x - b.z, real(0), b.x + real(2) * b.z);
        part *= real(0.75);
    }
    return sum;
}

// The albedo of a ground with structure, where the mean of f is `mean`: albedo * (1 + structure * mean). What is so
// bright that it would be above 1 varies less.
BRUME_FN BRUME_VEC3 groundAlbedo(BRUME_VEC3 albedo, real structure, real mean) {
    return albedo + min(structure * albedo, real(1) - albedo) * mean;
}

BRUME_PHYSICS_END

#endif
