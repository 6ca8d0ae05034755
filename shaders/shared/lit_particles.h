// The medium as a viewer draws it by itself: from particles that bring their light with them. Every particle adds to
// slabs of a ray what it has in them. Sums need no order, so nothing is sorted and nothing pops. The slabs lie where
// the ray's medium is; the first and the last one take what lies beyond.
//
// Places on a ray are q, in units of 1/k from a particle's closest approach; u = k (x - centre) is a place in it.
#ifndef BRUME_SHARED_LIT_PARTICLES_H
#define BRUME_SHARED_LIT_PARTICLES_H

#include "transmittance.h"

BRUME_PHYSICS_BEGIN

// A fit to the part of the sun's light that arrives in a particle: T(u) = middle + slope . u + u . M u. bend: the
// diagonal of M; twist: its elements yz, zx and xy.
BRUME_STRUCT LitFit {
    real middle;
    BRUME_VEC3 slope, bend, twist;
};

// The same along a ray: T(q) = middle + slope q + bend q^2.
BRUME_STRUCT LitLine { real middle, slope, bend; };
// nearest: u of the ray's closest approach; w: its unit direction.
BRUME_FN BRUME_OF(LitLine) litLine(BRUME_OF(LitFit) fit, BRUME_VEC3 nearest, BRUME_VEC3 w) {
    const BRUME_VEC3 m_nearest = BRUME_VEC3(fit.bend.x * nearest.x + fit.twist.z * nearest.y + fit.twist.y * nearest.z,
                                            fit.twist.z * nearest.x + fit.bend.y * nearest.y + fit.twist.x * nearest.z,
                                            fit.twist.y * nearest.x + fit.twist.x * nearest.y + fit.bend.z * nearest.z);
    const BRUME_VEC3 m_w = BRUME_VEC3(fit.bend.x * w.x + fit.twist.z * w.y + fit.twist.y * w.z,
                                      fit.twist.z * w.x + fit.bend.y * w.y + fit.twist.x * w.z,
                                      fit.twist.y * w.x + fit.twist.x * w.y + fit.bend.z * w.z);
    BRUME_OF(LitLine) line;
    line.middle = fit.middle + dot(fit.slope, nearest) + dot(m_nearest, nearest);
    line.slope = dot(fit.slope, w) + real(2) * dot(m_w, nearest);
    line.bend = dot(m_w, w);
    return line;
}

// Integrals of e^(-q^2) / sqrt(pi) times 1, q and q^2 up to q, all but constants: differences of two are those between.
BRUME_STRUCT LitSums { real whole, first, second; };
BRUME_FN BRUME_OF(LitSums) litSums(real q) {
    const real at = clamp(q, real(-9), real(9));
    const real gaussian = exp(-at * at);
    const real tail = real(0.5) * gaussian * erfcx(abs(at));
    BRUME_OF(LitSums) sums;
    sums.whole = at < real(0) ? tail - real(0.5) : real(0.5) - tail;
    sums.first = real(-0.28209479177387814) * gaussian;
    sums.second = real(0.5) * sums.whole + at * sums.first;
    return sums;
}

// What a particle has between two places of a ray whose whole line through it has the optical depth `line`: optical
// depth, and that times the light.
BRUME_STRUCT LitPart { real depth, lit; };
BRUME_FN BRUME_OF(LitPart) litPart(real line, BRUME_OF(LitLine) light, BRUME_OF(LitSums) from, BRUME_OF(LitSums) to) {
    const real whole = max(to.whole - from.whole, real(0));
    BRUME_OF(LitPart) part;
    part.depth = line * whole;
    part.lit = clamp(
        line * (light.middle * whole + light.slope * (to.first - from.first) + light.bend * (to.second - from.second)),
        real(0), part.depth);
    return part;
}

// What a particle adds to the moments of a ray's medium behind the place `from`: its optical depth, that times the
// distance, and times the square of it. closest: m, distance of the closest approach from where distances count.
BRUME_FN BRUME_VEC3 litMoments(real line, real k, real closest, BRUME_OF(LitSums) from) {
    const real whole = real(0.5) - from.whole, first = -from.first / k, second = (real(0.25) - from.second) / (k * k);
    return line *
           BRUME_VEC3(whole, closest * whole + first, closest * closest * whole + real(2) * closest * first + second);
}

// Where the slabs of a ray lie, m from where distances count. They reach over 2.2 deviations of its medium each way,
// and are the thinner in front, the denser it is: what lies behind is hidden.
BRUME_STRUCT LitRange { real begin, end, power; };
BRUME_FN BRUME_OF(LitRange) litRange(BRUME_VEC3 moments, real nearest) {
    const real depth = max(moments.x, real(1e-20)), mean = moments.y / depth;
    const real deviation = sqrt(max(moments.z / depth - mean * mean, real(1e-12)));
    BRUME_OF(LitRange) range;
    range.begin = max(mean - real(2.2) * deviation, nearest);
    range.end = max(mean + real(2.2) * deviation, range.begin + real(1e-6));
    range.power = real(1) + real(0.15) * log(real(1) + depth);
    return range;
}
// m, where the first part of the slabs ends, in [0, 1]: 1/8 after the first of eight.
BRUME_FN real litEdge(BRUME_OF(LitRange) range, real part) {
    return range.begin + (range.end - range.begin) * (part > real(0) ? exp(range.power * log(part)) : real(0));
}

// What a slab of optical depth `depth` sends to its front for a source of 1 all through it, and besides for one that
// grows by 1 from its front to its back.
BRUME_FN real litEven(real depth) { return depth * phi(depth); }
BRUME_FN real litRising(real depth) {
    const real d = min(depth, real(1e6));
    const real series = d * d * (real(-1.0 / 12.0) + d * (real(1.0 / 24.0) - d * real(1.0 / 80.0)));
    const real plain = (real(1) / max(d, real(0.1)) - real(0.5)) - exp(-d) * (real(1) / max(d, real(0.1)) + real(0.5));
    return d < real(0.3) ? series : plain;
}

// The light that a slab sends to its front. before, own, behind: optical depth times source of the slab before it, of
// itself and of the one behind; depths: their optical depths. 0: there is none.
BRUME_FN real litSlab(real before, real own, real behind, BRUME_VEC3 depths) {
    if (!(depths.y > real(1e-12))) return real(0);
    const real source = own / depths.y, least = real(1e-3) * depths.y;
    const real from = depths.x > least ? before / depths.x : source, to = depths.z > least ? behind / depths.z : source;
    const real even = litEven(depths.y) * source;
    return clamp(even + real(0.5) * (to - from) * litRising(depths.y), real(0.5) * even, real(2) * even);
}

// What of a slab's sum lies before the part `at` of its length, in [0, 1]. sums: of the slab before it, its own, and of
// the one behind; 0 where there is none. lengths: theirs, > 0. What is summed up along the ray is a monotone cubic,
// whose slope between two slabs is the harmonic mean of theirs (Fritsch and Butland 1984).
BRUME_FN real litBefore(BRUME_VEC3 sums, BRUME_VEC3 lengths, real at) {
    const real front = sums.x / lengths.x, own = sums.y / lengths.y, back = sums.z / lengths.z;
    const real from = real(2) * front * own / max(front + own, real(1e-30)),
               to = real(2) * back * own / max(back + own, real(1e-30));
    const real square = at * at, cube = square * at;
    return clamp(sums.y * (real(3) * square - real(2) * cube) +
                     lengths.y * (from * (at - real(2) * square + cube) + to * (cube - square)),
                 real(0), sums.y);
}

BRUME_PHYSICS_END

#endif
