// Light scattered toward the eye by one particle on one interval: C = rho p E * integral of S T_V sigma dz. The caller
// provides S = T_L * visibility. A quadrature is a sum over nodes, C = rho p E * sum of node.weight * S(node.z), with
// finite weights for all inputs.
#ifndef BRUME_SHARED_SCATTER_H
#define BRUME_SHARED_SCATTER_H

#include "transmittance.h"

BRUME_PHYSICS_BEGIN

// C / (rho p E) of one medium among several in an interval, if the optical depth that is passed, to the light and from
// the interval's begin toward the eye together, is linear in the medium's own. own: its own depth; in_depth, out_depth:
// those sums at its entry and exit. Exact for height fog and for homogeneous fog, lit past themselves, of any depth.
BRUME_FN real scatterOwn(real own, real in_depth, real out_depth) {
    const real from = min(in_depth, real(1e18)), to = min(out_depth, real(1e18));
    return min(own, real(1e18)) * exp(-min(from, to)) * phi(abs(to - from));
}

// C / (rho p E) if light depth is linear in view depth. depth: of the interval; light_in, light_out: light depth at
// its entry and exit. Exact for a homogeneous interval.
BRUME_FN real scatterAnalytic(real depth, real light_in, real light_out) {
    const real t = min(depth, real(1e18));
    const real in_depth = min(light_in, real(1e18));
    const real out_depth = t + min(light_out, real(1e18));
    return t * exp(-min(in_depth, out_depth)) * phi(abs(out_depth - in_depth));
}

// scatterAnalytic() of an interval where extinction is not uniform and light depth not linear, over that of one where
// they are; in [0.5, 2]. slope: change of the extinction over the interval, as a part of its mean, in [-2, 2]. bend:
// second difference of the light depth, for intervals as long as this one. To first order in both the ratio is
// 1 + (bend - slope (light_out - light_in)) / 12: what scatters more is lit less. So errors of intervals fall with the
// fourth power of their length, and not with the second. Where light or view fade within the interval it goes to 1.
BRUME_FN real scatterVaried(real depth, real light_in, real light_out, real slope, real bend) {
    const real rise = min(max(light_out - light_in, real(-1e4)), real(1e4));
    const real bent = min(max(bend, real(-1e4)), real(1e4));
    const real fading = min(depth, real(1e4)) + rise;
    const real part = (bent - slope * rise) / (real(12) + (fading * fading + real(4) * bent * bent) / real(3));
    return real(1) + min(max(part, real(-0.5)), real(1));
}

// Part, in [0, 1], of what an interval adds to a sum along a ray that is added before the part `at` of its length.
// before, own, behind: what the interval before it, itself and the one behind it add, >= 0, if all have one length; 0
// before or behind: unknown. Exact where it grows or falls geometrically: a homogeneous medium, lit along a line.
BRUME_FN real addedBefore(real before, real own, real behind, real at) {
    const real least = real(1e-30), most = real(8);
    if (own < least) return at;
    const real middle = log(own);
    const real from = before > least ? middle - log(before) : real(0);
    const real to = behind > least ? log(behind) - middle : real(0);
    const real known = before > least && behind > least ? real(2) : real(1);
    const real rate = min(max((from + to) / known, -most), most);
    const real size = abs(rate), part = rate > real(0) ? real(1) - at : at;
    const real reached = part * phi(size * part) / phi(size);
    return rate > real(0) ? real(1) - reached : reached;
}

BRUME_STRUCT ScatterNode {
    real weight; // of S at this node
    real z;      // m along the ray, from the segment's entry (Hermite: from the closest approach)
};

// Extinction times T_V times length, at the part `along` of a segment's length; T_V counts from its entry. An integral
// over the segment is the mean of this along it.
BRUME_FN real segmentSource(BRUME_OF(GaussianSegment) segment, real along) {
    const real c = segment.a + segment.h * along;
    const real gaussian = exp(-c * c);
    const real tail = gaussian * erfcx(abs(c));
    const real depth = real(0.5) * segment.line * erfBetween(segment.a, segment.tail_a, c, tail);
    return min(segment.h / segment.k * (segment.peak * gaussian), real(1e30)) * exp(-depth);
}

// The same of a segment whose extinction is even; depth: its optical depth.
BRUME_FN real evenSource(real depth, real along) { return min(depth, real(1e30)) * exp(-depth * along); }

// A rule for means over an interval: the part of its length at which a node lies, and its weight.
BRUME_STRUCT RuleNode {
    real along;
    real weight;
};

// Composite Simpson: node j of 0 ... 2n for n >= 1 steps.
BRUME_FN BRUME_OF(RuleNode) simpsonRule(int j, int n) {
    const real rule = (j == 0 || j == 2 * n) ? real(1) : ((j & 1) == 1 ? real(4) : real(2));
    BRUME_OF(RuleNode) node;
    node.along = real(j) / real(2 * n);
    node.weight = rule / real(6 * n);
    return node;
}

// Taylor series about the middle a of the interval, four terms, with forward differences as derivatives (seed 000
// section 3.9): the sum of f^(n)(a) (x - a)^(n + 1) / (n + 1)! for n = 0 ... 3, at the end less that at the begin.
// Terms of odd n are equal at both and cancel. The mean that is left is f(a) + length^2 f''(a) / 24, from nodes j = 0
// ... 2 at a + j steps. `step`: a part of the length; the seed prints none. Exact for polynomials of degree 2. Of
// degree 3 it errs by f''' step length^2 / 24. The series does not converge over a particle: a control that fails.
BRUME_FN BRUME_OF(RuleNode) taylorRule(int j, real step) {
    const real second = real(1) / (real(24) * step * step);
    BRUME_OF(RuleNode) node;
    node.along = real(0.5) + real(j) * step;
    node.weight = j == 0 ? real(1) + second : (j == 1 ? real(-2) * second : second);
    return node;
}

// Composite Simpson on a segment: node j of 0 ... 2n for n >= 1 steps.
BRUME_FN BRUME_OF(ScatterNode) simpsonNode(BRUME_OF(GaussianSegment) segment, int j, int n) {
    const BRUME_OF(RuleNode) rule = BRUME_OF(simpsonRule)(j, n);
    BRUME_OF(ScatterNode) node;
    node.weight = rule.weight * segmentSource(segment, rule.along);
    node.z = segment.h / segment.k * rule.along;
    return node;
}

// What seed 000 adds to C / (rho p E) of one particle for multiple scattering (section 3.12, eq. 11). part: extinction
// in the middle of its interval, over that of its centre; m: in [0, 1]. It is not physical: it knows neither depth nor
// light, and grows with the number of particles on a ray.
BRUME_FN real legacyMultiple(real part, real m) { return part * real(0.001) * m; }

// Gauss-Legendre on (0, 1): node i of n in 1 ... 3 (more count as 3).
BRUME_FN real legendreNode(int i, int n) {
    const real reach = n <= 1 ? real(0) : (n == 2 ? real(0.28867513459481287) : real(0.3872983346207417));
    const real side = n == 2 ? real(2 * i - 1) : real(i - 1);
    return real(0.5) + reach * side;
}

BRUME_FN real legendreWeight(int i, int n) {
    const real three = i == 1 ? real(4.0 / 9.0) : real(5.0 / 18.0);
    return n <= 1 ? real(1) : (n == 2 ? real(0.5) : three);
}

// The part of an interval's optical depth at which a part xi of its opacity is reached; in [0, 1] for xi in (0, 1).
BRUME_FN real depthPart(real depth, real xi) {
    const real series =
        xi * (real(1) - depth * (real(1) - xi) * (real(0.5) - depth * (real(1) - real(2) * xi) / real(6)));
    const real full = -log(max((real(1) - xi) + xi * exp(-depth), real(1e-37))) / max(depth, real(0.05));
    return depth < real(0.05) ? series : full;
}

// Position q in [a, a + h], units of 1/k, at which the part s of the segment's optical depth is reached.
BRUME_FN real segmentQuantile(BRUME_OF(GaussianSegment) segment, real s) {
    const real c = segment.a + segment.h;
    const real above_a = segment.a < real(0) ? real(2) - segment.tail_a : segment.tail_a;
    const real above_c = c < real(0) ? real(2) - segment.tail_c : segment.tail_c;
    const real below_a = segment.a < real(0) ? segment.tail_a : real(2) - segment.tail_a;
    const real below_c = c < real(0) ? segment.tail_c : real(2) - segment.tail_c;
    // erfc(q) and erfc(-q), each a mean of positive numbers; the smaller one is inverted.
    const real above = above_a * (real(1) - s) + above_c * s;
    const real below = below_a * (real(1) - s) + below_c * s;
    const real q = erfcInverse(min(above, below));
    return clamp(above < below ? q : -q, segment.a, c);
}

// m from a segment's entry to where the part s of its optical depth is reached.
BRUME_FN real segmentPlace(BRUME_OF(GaussianSegment) segment, real s) {
    return min(BRUME_OF(segmentQuantile)(segment, s) - segment.a, segment.h) / segment.k;
}

// Transmittance space: node i of n in 1 ... 3, placed where light that reaches the eye is scattered. The weights sum
// to 1 - T exactly.
BRUME_FN BRUME_OF(ScatterNode) transmittanceNode(BRUME_OF(GaussianSegment) segment, int i, int n) {
    const real s = depthPart(segment.depth, BRUME_OF(legendreNode)(i, n));
    BRUME_OF(ScatterNode) node;
    node.weight = BRUME_OF(legendreWeight)(i, n) * opacity(segment.depth);
    node.z = BRUME_OF(segmentPlace)(segment, s);
    return node;
}

// Gauss-Hermite with 2 nodes for the whole line: node 0 before, 1 behind the closest approach; z counts from there. The
// weights are those of T_V at the nodes, normalised so that they sum to 1 - T exactly.
BRUME_FN BRUME_OF(ScatterNode) hermiteNode(real line, real k, int i) {
    // T_V(far) / T_V(near) = exp(-line * erf(1/sqrt 2))
    const real ratio = exp(real(-0.6826894921370859) * line);
    BRUME_OF(ScatterNode) node;
    node.weight = (i == 0 ? real(1) : ratio) / (real(1) + ratio) * opacity(line);
    node.z = (i == 0 ? real(-0.7071067811865476) : real(0.7071067811865476)) / max(k, real(1e-20));
    return node;
}

// Mean and standard deviation of the Gaussian on a segment, units of 1/k from the closest approach: 0 and sqrt(1/2)
// of a whole line. Far out in the tail the mean is only known to lie beyond the nearer end.
BRUME_STRUCT SegmentMoments { real mean, deviation; };
BRUME_FN BRUME_OF(SegmentMoments) segmentMoments(BRUME_OF(GaussianSegment) segment) {
    const real a = segment.a;
    const real c = segment.a + segment.h;
    const real gaussian_a = exp(-min(a * a, real(80)));
    const real gaussian_c = exp(-min(c * c, real(80)));
    // 1 / (2 integral of exp(-q^2)) = 1 / (sqrt(pi) (erf c - erf a)); depth / line is half of erf c - erf a;
    // bounded where the segment lies so far out that the clamp below decides.
    const real scale = real(0.28209479177387814) * min(segment.line / max(segment.depth, real(1e-30)), real(1e15));
    BRUME_OF(SegmentMoments) moments;
    moments.mean = (gaussian_a - gaussian_c) * scale;
    const real variance = real(0.5) + (a * gaussian_a - c * gaussian_c) * scale - moments.mean * moments.mean;
    moments.deviation = sqrt(clamp(variance, real(0), real(0.5)));
    return moments;
}

// Two nodes for a segment that the near plane or an object cuts: mean -+ standard deviation of the truncated
// Gaussian, which are Hermite's for the whole line; z counts from the segment's entry. The weights sum to 1 - T
// exactly. Cheaper than transmittanceNode, which inverts erf.
BRUME_FN BRUME_OF(ScatterNode) truncatedHermiteNode(BRUME_OF(GaussianSegment) segment, int i) {
    const BRUME_OF(SegmentMoments) moments = segmentMoments(segment);
    const real ratio = exp(real(-0.6826894921370859) * segment.depth);
    BRUME_OF(ScatterNode) node;
    node.weight = (i == 0 ? real(1) : ratio) / (real(1) + ratio) * opacity(segment.depth);
    const real q =
        clamp(moments.mean + (i == 0 ? -moments.deviation : moments.deviation), segment.a, segment.a + segment.h);
    node.z = min(q - segment.a, segment.h) / segment.k;
    return node;
}

// Distance, in sqrt(2) standard deviations, of the mean point of scattering before the Gaussian's mean on a segment.
// Exact for thin segments; on whole lines the error is below 1e-3 up to a depth of 2.5, and 0.05 up to 10.
BRUME_FN real scatterShift(real depth) {
    return real(0.19947114020071635) * depth / sqrt(real(1) + real(0.029) * depth * depth);
}

BRUME_PHYSICS_END

#endif
