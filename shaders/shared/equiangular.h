// Places along a ray by the angle under which a light sees them (Kulla and Fajardo, Importance Sampling Techniques for
// Path Tracing in Participating Media, 2012). Light that falls with the square of the distance is even in that angle:
// the integral of f dt / (t^2 + h^2) is that of f d(angle) / h. Metres along the ray, from its place closest to the
// light.
#ifndef BRUME_SHARED_EQUIANGULAR_H
#define BRUME_SHARED_EQUIANGULAR_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// A part of the ray.
BRUME_STRUCT EquiangularPart {
    real begin;  // m
    real height; // h: distance of the ray from the light, m; at least 1e-6
    real angle;  // between the directions to its ends, in [0, pi]
};

// The part between `begin` and `end`, at most 1e15 m away; height: from 0 on.
BRUME_FN BRUME_OF(EquiangularPart) equiangularPart(real height, real begin, real end) {
    BRUME_OF(EquiangularPart) part;
    const real h = max(height, real(1e-6));
    part.begin = begin;
    part.height = h;
    part.angle = atan(h * (end - begin), h * h + begin * end);
    return part;
}

// The place that a part u of the angle is before, u in [0, 1]. The tangents' sum keeps what differences of angles near
// a right one would lose.
BRUME_FN real equiangularPlace(BRUME_OF(EquiangularPart) part, real u) {
    const real turned = tan(u * part.angle), h = part.height;
    return h * (part.begin + h * turned) / (h - part.begin * turned);
}

// Integral of dt / (t^2 + h^2) over the part, 1/m.
BRUME_FN real equiangularWeight(BRUME_OF(EquiangularPart) part) { return part.angle / part.height; }

BRUME_PHYSICS_END

#endif
