// Fog: a medium without particles. Its extinction is sigma_t e^(-falloff (y - base)) between two heights and within a
// ball, and 0 elsewhere. Metres, extinction in 1/m. Heights of 1e30 and radii from 1e15 on stand for "without limit".
#ifndef BRUME_SHARED_FOG_H
#define BRUME_SHARED_FOG_H

#include "transmittance.h"

BRUME_PHYSICS_BEGIN

// A part of a ray, in units of its direction; empty where begin >= end.
BRUME_STRUCT FogPart {
    real begin;
    real end;
};

// The part between `begin` and `end` of the ray origin + t dir that lies in the fog. `dir` has any length but 0.
BRUME_FN BRUME_OF(FogPart) insideFog(real lo, real hi, BRUME_VEC3 centre, real radius, BRUME_VEC3 origin,
                                     BRUME_VEC3 dir, real begin, real end) {
    BRUME_OF(FogPart) part;
    part.begin = begin;
    part.end = end;
    if (abs(dir.y) > real(1e-12)) {
        const real a = (lo - origin.y) / dir.y, b = (hi - origin.y) / dir.y;
        part.begin = max(part.begin, min(a, b));
        part.end = min(part.end, max(a, b));
    } else if (origin.y < lo || origin.y > hi) {
        part.end = part.begin;
    }
    if (radius < real(1e15)) {
        const BRUME_VEC3 from = origin - centre;
        const real square = dot(dir, dir), closest = -dot(from, dir) / square;
        const BRUME_VEC3 off = from + closest * dir;
        const real half_chord = sqrt(max(radius * radius - dot(off, off), real(0)) / square);
        part.begin = max(part.begin, closest - half_chord);
        part.end = min(part.end, closest + half_chord);
    }
    return part;
}

// Optical depth of such a part, at most 1e18. `height`: of the ray's origin above the base; `climb`: change of height
// per unit of t; `metres`: length per unit of t. The exponent that is taken out is that of the lowest point, so that
// nothing overflows before the result does.
BRUME_FN real fogDepth(real sigma_t, real falloff, real height, real climb, real metres, real begin, real end) {
    if (!(end > begin)) return real(0);
    const real from = height + climb * begin, length = end - begin;
    const real lowest = min(from, height + climb * end);
    const real densest = sigma_t * exp(min(-falloff * lowest, real(60)));
    return min(densest * (metres * length * phi(falloff * abs(climb) * length)), real(1e18));
}

// How far, in units of t, a ray goes on from `begin` until the optical depth is `depth`, at most 1e30; of fog without
// limits. `height`, `climb` and `metres` as for fogDepth().
BRUME_FN real fogDistance(real sigma_t, real falloff, real height, real climb, real metres, real begin, real depth) {
    const real density = sigma_t * metres * exp(min(-falloff * (height + climb * begin), real(60)));
    if (density < real(1e-30)) return real(1e30);
    const real x = depth / density * (falloff * climb); // the part of all fog that is left on the ray
    if (x >= real(1)) return real(1e30);
    const bool small = abs(x) < real(0.02);
    const real plain = -log(real(1) - x) / (small ? real(1) : x);
    const real series = real(1) + x * (real(1.0 / 2.0) + x * (real(1.0 / 3.0) + x * real(1.0 / 4.0)));
    return min(depth / density * (small ? series : plain), real(1e30));
}

BRUME_PHYSICS_END

#endif
