// Colours of views (show.h): where a value lies on its scale, and the colour there. Legends are made of the same
// functions. Source of viridis and inferno: matplotlib's maps, as the polynomials of M. Zucker
// (shadertoy.com/view/WlfXRN, public domain), within 0.035 of them.
#ifndef BRUME_SHARED_SHOW_COLOURS_H
#define BRUME_SHARED_SHOW_COLOURS_H

#include "real.h"
#include "show.h"

BRUME_PHYSICS_BEGIN
#ifdef __cplusplus
using gpu::kShowDepth, gpu::kShowError, gpu::kShowLight, gpu::kShowOverdraw, gpu::kShowParticles, gpu::kShowRays;
using gpu::kShowShadow, gpu::kShowWasted, gpu::uint;
#endif

// sRGB, in [0, 1], of a part in [0, 1]. Both are perceptually uniform, from dark to bright.
BRUME_FN BRUME_VEC3 viridis(real t) {
    const BRUME_VEC3 c0 = BRUME_VEC3(real(0.2777273), real(0.0054073), real(0.3340998));
    const BRUME_VEC3 c1 = BRUME_VEC3(real(0.1050930), real(1.4046135), real(1.3845902));
    const BRUME_VEC3 c2 = BRUME_VEC3(real(-0.3308618), real(0.2148476), real(0.0950952));
    const BRUME_VEC3 c3 = BRUME_VEC3(real(-4.6342305), real(-5.7991010), real(-19.3324410));
    const BRUME_VEC3 c4 = BRUME_VEC3(real(6.2282699), real(14.1799334), real(56.6905526));
    const BRUME_VEC3 c5 = BRUME_VEC3(real(4.7763850), real(-13.7451454), real(-65.3530326));
    const BRUME_VEC3 c6 = BRUME_VEC3(real(-5.4354559), real(4.6458526), real(26.3124352));
    return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
}
BRUME_FN BRUME_VEC3 inferno(real t) {
    const BRUME_VEC3 c0 = BRUME_VEC3(real(0.0002189), real(0.0016510), real(-0.0194809));
    const BRUME_VEC3 c1 = BRUME_VEC3(real(0.1065134), real(0.5639564), real(3.9327124));
    const BRUME_VEC3 c2 = BRUME_VEC3(real(11.6024931), real(-3.9728540), real(-15.9423941));
    const BRUME_VEC3 c3 = BRUME_VEC3(real(-41.7039961), real(17.4363989), real(44.3541452));
    const BRUME_VEC3 c4 = BRUME_VEC3(real(77.1629357), real(-33.4023589), real(-81.8073093));
    const BRUME_VEC3 c5 = BRUME_VEC3(real(-71.3194282), real(32.6260643), real(73.2095199));
    const BRUME_VEC3 c6 = BRUME_VEC3(real(25.1311262), real(-12.2426690), real(-23.0703250));
    return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
}
// From green over yellow to red.
BRUME_FN BRUME_VEC3 greenToRed(real t) {
    const BRUME_VEC3 green = BRUME_VEC3(real(0.10), real(0.60), real(0.31));
    const BRUME_VEC3 yellow = BRUME_VEC3(real(0.99), real(0.88), real(0.55));
    const BRUME_VEC3 red = BRUME_VEC3(real(0.80), real(0.10), real(0.13));
    const real to = min(real(2) * t, real(1)), from = max(real(2) * t - real(1), real(0));
    return (green + to * (yellow - green)) + from * (red - yellow);
}

// Least and largest value of a view's scale; what lies beyond has the colour of that end. 0: the scale is linear, for
// parts; all others are logarithmic.
BRUME_FN real leastShown(uint show) {
    if (show == kShowDepth || show == kShowShadow) return real(0.01);
    if (show == kShowError) return real(1e-4);
    return show == kShowWasted || show == kShowLight ? real(0) : real(1);
}
BRUME_FN real mostShown(uint show) {
    if (show == kShowOverdraw || show == kShowParticles) return real(10000);
    if (show == kShowRays) return real(512);
    return show == kShowDepth || show == kShowShadow ? real(10) : real(1);
}
// Where a value >= 0 lies on a view's scale, in [0, 1].
BRUME_FN real shownPart(uint show, real value) {
    const real lo = BRUME_OF(leastShown)(show), hi = BRUME_OF(mostShown)(show);
    const real part = lo > real(0) ? log(max(value, lo) / lo) / log(hi / max(lo, real(1e-6))) : value / hi;
    return min(max(part, real(0)), real(1));
}
// sRGB, in [0, 1], of a part of a view's scale.
BRUME_FN BRUME_VEC3 shownColour(uint show, real part) {
    BRUME_VEC3 colour = BRUME_OF(viridis)(part);
    if (show == kShowWasted) colour = BRUME_OF(greenToRed)(part);
    if (show >= kShowDepth) colour = BRUME_OF(inferno)(real(0.12) + real(0.88) * part); // darker cannot be seen
    for (int c = 0; c < 3; ++c) colour[c] = min(max(colour[c], real(0)), real(1));
    return colour;
}

BRUME_PHYSICS_END

#endif
