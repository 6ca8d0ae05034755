// Extinction within a slab, from the depths of its neighbours: it grows or falls by the same part on equal lengths, but
// for a bend. Against an even one, errors of light that varies within slabs fall with the fourth power of their
// thickness, and not with the second. Of a Gaussian they are about those of parabolas through more slabs, and
// extinction is never negative.
#ifndef BRUME_SHARED_SLAB_GROWTH_H
#define BRUME_SHARED_SLAB_GROWTH_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// Of the logarithm of extinction: `growth` over the slab, in [-8, 8]; `bend`, by how much more over the next one, in
// [-4, 2].
BRUME_STRUCT GrownSlab {
    real growth;
    real bend;
    real least; // exp(-growth / 2), extinction at its begin, and what it is more at its end; without bend
    real span;
    real square; // mean square of the place, from the slab's middle
};

// Of a slab's depth, what grownSlab() takes. 0: unknown.
BRUME_FN real slabLog(real depth) { return log(max(depth, real(1e-30))); }

// before, own, behind: slabLog() of the slab before it, of itself and of the one behind it, if all have one length.
BRUME_FN BRUME_OF(GrownSlab) grownSlab(real before, real own, real behind) {
    const real known = real(-69), most = real(8);
    const bool has_before = own > known && before > known, has_behind = own > known && behind > known;
    const real from = has_before ? min(max(own - before, -most), most) : real(0);
    const real to = has_behind ? min(max(behind - own, -most), most) : real(0);
    const bool both = has_before && has_behind;
    const real growth = both ? real(0.5) * (from + to) : from + to;
    BRUME_OF(GrownSlab) slab;
    slab.growth = abs(growth) < real(2e-3) ? real(0) : growth;
    slab.bend = both ? min(max(to - from, real(-4)), real(2)) : real(0);
    slab.least = exp(real(-0.5) * slab.growth);
    slab.span = real(1) / slab.least - slab.least;
    slab.square = real(0.25) - real(2) / (real(12) + real(0.2) * growth * growth);
    return slab;
}

// At the part `at` of the slab's length: the extinction, as a part of its mean, and the part of its depth before that
// place.
BRUME_STRUCT GrownPlace {
    real extinction;
    real before;
};

BRUME_FN BRUME_OF(GrownPlace) grownPlace(BRUME_OF(GrownSlab) slab, real at) {
    BRUME_OF(GrownPlace) place;
    const bool even = slab.growth == real(0);
    const real x = at - real(0.5), here = exp(slab.growth * x), span = even ? real(1) : slab.span;
    const real bent = real(1) + real(0.5) * slab.bend * (x * x - slab.square);
    place.extinction = (even ? real(1) : slab.growth * here / span) * bent;
    place.before = even ? at : (here - slab.least) / span;
    return place;
}

// How far the mean place of the slab's depth is behind its middle, as a part of its length. Its error is below 0.006 up
// to a growth of 4.
BRUME_FN real grownShift(BRUME_OF(GrownSlab) slab) {
    return slab.growth / (real(12) + real(0.2) * slab.growth * slab.growth);
}

BRUME_PHYSICS_END

#endif
