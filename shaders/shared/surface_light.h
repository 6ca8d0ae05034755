// Parts of surfaces as a place sees them: directions toward them and their solid angles.
#ifndef BRUME_SHARED_SURFACE_LIGHT_H
#define BRUME_SHARED_SURFACE_LIGHT_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// 1 - cosine of half the angle under which a sphere is seen; the solid angle is 2 pi of it. part: its radius over the
// distance of its centre, in [0, 1].
BRUME_FN real sphereEdge(real part) {
    const real square = min(part * part, real(1));
    return square / (real(1) + sqrt(real(1) - square));
}

// Direction `i` of parts^2 in a cone around +z, unit: parts of equal solid angle, as many on each of `parts` rings.
// With two and more they have no net direction but the cone's axis, which is the direction of one part. edge: 1 -
// cosine of the cone's half angle, in [0, 2].
BRUME_FN BRUME_VEC3 coneDirection(int i, int parts, real edge) {
    if (parts == 1) return BRUME_VEC3(0, 0, 1);
    const int ring = i / parts;
    const real below = edge * (real(ring) + real(0.5)) / real(parts);
    const real sine = sqrt(max(below * (real(2) - below), real(0)));
    const real turn =
        real(6.283185307179586) * (real(i - ring * parts) / real(parts) + real(0.6180339887) * real(ring));
    return BRUME_VEC3(sine * cos(turn), sine * sin(turn), real(1) - below);
}

// The boundary `i` of `parts` between lo and hi on a line, as seen from a place that is `height` > 0 away from the
// line's foot at 0: all parts are seen under the same angle.
BRUME_FN real evenAngle(real i, real parts, real lo, real hi, real height) {
    if (i <= real(0)) return lo;
    if (i >= parts) return hi;
    const real from = atan(lo, height), to = atan(hi, height);
    return clamp(height * tan(mix(from, to, i / parts)), lo, hi);
}

// Solid angle, sr, of the rectangle between the foot of the perpendicular to its plane, of the length z > 0, and the
// corner (x, y); with the sign of x y.
BRUME_FN real cornerSolidAngle(real x, real y, real z) { return atan(x * y, z * sqrt(x * x + y * y + z * z)); }

// Solid angle, sr, of the rectangle (x0, y0) ... (x1, y1) from the height z > 0 above its plane. A small one far away
// has its area's, with a relative error of 1e-3: the difference of corners would be lost in rounding.
BRUME_FN real rectangleSolidAngle(real x0, real y0, real x1, real y1, real z) {
    const real wide = x1 - x0, high = y1 - y0, x = real(0.5) * (x0 + x1), y = real(0.5) * (y0 + y1);
    const real square = x * x + y * y + z * z;
    if (wide * wide + high * high < real(2e-3) * square) return wide * high * z / (square * sqrt(square));
    return max(cornerSolidAngle(x1, y1, z) - cornerSolidAngle(x0, y1, z) - cornerSolidAngle(x1, y0, z) +
                   cornerSolidAngle(x0, y0, z),
               real(0));
}

BRUME_PHYSICS_END

#endif
