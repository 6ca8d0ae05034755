// Adds a splat to the pixels of one lane: kPixels neighbours in a row. Include after the eye,
// the scene's features (kHas..., kMayBeCut, kOneAlbedo), kCached and kPixels are declared.
#include "shaders/shared/scatter.h"
#include "shaders/lib/even_light.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/eye.glsl"

const uint kGroup = 4;             // pixels that are tested together before a splat is evaluated
const float kThin = -2;            // log2 of the largest optical depth for thinOpacity()
const float kShift = 0.19947114;   // scatterShift() for small depths
const float kLog2e = 1.4426950408889634;

// State of the lane's pixels.
vec2 first;                                            // position of the first pixel
float inverse_length[kPixels], inverse_square[kPixels]; // 1 / |d|, 1 / d^2; d: the ray's direction of unit view depth
float begin[kPixels], end[kPixels];                    // m along the ray: near plane and opaque surface
float transmittance[kPixels];
vec3 scattered[kPixels]; // sum of albedo T_V T_L (1 - T) over splats; without the albedo if all have the same
vec3 hidden[kPixels];    // sum of albedo T_V (1 - T), for evenLight()
float log_cut;           // log2 of Tick::cut

// A splat on these pixels: affine functions as the value at the first pixel and the step to the next.
struct Run {
    vec2 x;
    float y2; // second coordinate across the line of sight, see Splat
    vec2 along, slope;
    float log_line, light, curvature, k; // curvature: times log_e 2
    vec3 albedo;
    vec2 way[3]; // of an ellipsoid: SplatWay
};

// Of an ellipsoid: the squared length of d in units of its semi-axes over that of d, at least 1. A ball: 1.
float stretched(Run s, uint p) {
    if (!kEllipsoids) return 1;
    const vec3 way = vec3(s.way[0].x + float(p) * s.way[0].y, s.way[1].x + float(p) * s.way[1].y,
                          s.way[2].x + float(p) * s.way[2].y);
    return dot(way, way) * inverse_square[p];
}

vec3 rayAt(uint p) { return rayDirection(first + vec2(p, 0)); }

// log2 of the optical depths of the whole lines through kGroup pixels from p0, of lines of the same direction through
// the centre, and stretched() there. False if none reaches the cut.
bool lines(Run s, uint p0, out float e[kGroup], out float centre[kGroup], out float stretch[kGroup]) {
    const float x0 = s.x.x + float(p0) * s.x.y;
    float most = -1e30;
    [[unroll]] for (uint r = 0; r < kGroup; ++r) {
        const float x = x0 + float(r) * s.x.y;
        stretch[r] = stretched(s, p0 + r);
        centre[r] = kEllipsoids ? s.log_line - 0.5 * log2(stretch[r]) : s.log_line;
        e[r] = centre[r] - (x * x + s.y2) * (inverse_square[p0 + r] / stretch[r]);
        most = max(most, e[r]);
    }
    return most >= log_cut;
}

// Adds a splat behind all previous ones. `lit`: opacity times the light's transmittance.
void add(uint p, vec3 albedo, float opacity, float lit) {
    const float in_front = transmittance[p];
    scattered[p] += kOneAlbedo ? vec3(in_front * lit, 0, 0) : in_front * lit * albedo;
    if ((kHasAmbient || kHasEmission) && !kOneAlbedo) hidden[p] += in_front * opacity * albedo;
    transmittance[p] = in_front - in_front * opacity;
}

// (1 - e^-x) / x for 0 <= x <= 1/4, relative error 2.6e-7.
float thinOpacity(float x) { return 0.99999977 - x * (0.49996999 - x * (0.16606225 - x * 0.03772897)); }

// Adds a thin, uncut splat with cached light. The linear part of the light is taken at the mean point of scattering.
void addThin(Run s) {
    const float shift = kShift / s.k;
    [[unroll]] for (uint p0 = 0; p0 < kPixels; p0 += kGroup) {
        float e[kGroup], centre[kGroup], stretch[kGroup];
        if (lines(s, p0, e, centre, stretch)) {
            const float along0 = s.along.x + float(p0) * s.along.y, slope0 = s.slope.x + float(p0) * s.slope.y;
            [[unroll]] for (uint r = 0; r < kGroup; ++r) {
                const uint p = p0 + r;
                const float depth = e[r] >= log_cut ? exp2(e[r]) : 0;
                const float along = along0 + float(r) * s.along.y, slope = slope0 + float(r) * s.slope.y;
                const float light = s.light + s.curvature * (centre[r] - e[r]) +
                                    slope * (along * (inverse_square[p] / stretch[r]) -
                                             depth * shift * (inverse_length[p] * inversesqrt(stretch[r])));
                const float opacity = depth * thinOpacity(depth);
                add(p, s.albedo, opacity, opacity * clamp(light, 0, 1));
            }
        }
    }
}

// Adds a thin splat that is cut on one side of each line: at the near plane (side 1) or at the opaque surface (side
// -1).
void addCut(Run s, float side) {
    [[unroll]] for (uint p0 = 0; p0 < kPixels; p0 += kGroup) {
        float e[kGroup], centre[kGroup], stretch[kGroup];
        if (lines(s, p0, e, centre, stretch)) {
            const float along0 = s.along.x + float(p0) * s.along.y, slope0 = s.slope.x + float(p0) * s.slope.y;
            [[unroll]] for (uint r = 0; r < kGroup; ++r) {
                const uint p = p0 + r;
                const float closest = (along0 + float(r) * s.along.y) * (inverse_length[p] / stretch[r]);
                const float k = s.k * sqrt(stretch[r]), inverse_k = 1 / k;
                const float bound = !kHasOpaque || side > 0 ? begin[p] : end[p];
                const float y = side * k * (bound - closest); // the part of exp(-q^2) above y remains
                // erfc(|y|) by Abramowitz and Stegun 7.1.26, error 1.5e-7
                const float gaussian = exp2(-kLog2e * y * y);
                const float t = 1 / (1 + 0.3275911 * abs(y));
                const float tail =
                    gaussian * t *
                    (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
                const float left = y < 0 ? 2 - tail : tail;
                const float half_line = e[r] >= log_cut ? 0.5 * exp2(e[r]) : 0;
                const float depth = half_line * left, part = thinOpacity(depth), opacity = depth * part;
                // Opacity * mean of |q|; times y: opacity * mean of q^2 - 1/2.
                const float moment = 0.5641895835477563 * half_line * part * gaussian;
                // Light hidden by the nearer part: as on a whole line, with left / 2 as variance.
                const float mean = side * moment - 0.5 * kShift * opacity * depth * left;
                const float slope = (slope0 + float(r) * s.slope.y) * inverse_length[p];
                const float lit = opacity * (s.light + s.curvature * (centre[r] - e[r]) + slope * closest) +
                                  slope * inverse_k * mean + kLog2e * s.curvature * y * moment;
                add(p, s.albedo, opacity, clamp(lit, 0, opacity));
            }
        }
    }
}

// T_L * visibility at `t` m along the ray of pixel p.
float lightArriving(uint p, float t) {
    const float depth = t * inverse_length[p]; // in view
    const vec3 ray = map_rays.ray + (first.x + float(p)) * map_rays.right + first.y * map_rays.down;
    float light = exp(-lightDepth(map_rays.eye + depth * ray));
    if (kHasCasters) light *= visibility(toLightSpace(eye.position + depth * rayAt(p)));
    return light;
}

// Adds any splat: of any depth, cut or not, with light cached or looked up at the two Gauss-Hermite points.
void addAny(Run s, bool cut, bool look_up) {
    [[unroll]] for (uint p0 = 0; p0 < kPixels; p0 += kGroup) {
        float e[kGroup], centre[kGroup], stretch[kGroup];
        if (lines(s, p0, e, centre, stretch)) {
            [[unroll]] for (uint r = 0; r < kGroup; ++r) {
                const uint p = p0 + r;
                const float closest = (s.along.x + float(p) * s.along.y) * (inverse_length[p] / stretch[r]);
                const float k = s.k * sqrt(stretch[r]);
                const float line = e[r] >= log_cut ? exp2(e[r]) : 0;
                float depth = line, a = -1e9, c = 1e9; // the segment, in units of 1/k from the closest approach
                SegmentMoments moments = SegmentMoments(0, 0.7071067811865476);
                if (kMayBeCut && cut) {
                    const float half_length = sqrt(max(e[r] - log_cut, 0) / kLog2e); // within the support
                    a = max(-half_length, k * (begin[p] - closest));
                    c = kHasOpaque ? min(half_length, k * (end[p] - closest)) : half_length;
                    const GaussianSegment segment = segmentOfLine(line, k, a, c - a);
                    depth = c > a ? segment.depth : 0;
                    moments = segmentMoments(segment);
                }
                float light;
                if (look_up) {
                    const float ratio = exp(-0.6826894921370859 * depth); // ratio of T_V at the points; erf(1/sqrt 2)
                    const float near = clamp(moments.mean - moments.deviation, a, c),
                                far = clamp(moments.mean + moments.deviation, a, c);
                    light = (lightArriving(p, closest + near / k) + ratio * lightArriving(p, closest + far / k)) /
                            (1 + ratio);
                } else {
                    const float q =
                        clamp(moments.mean - 1.4142135623730951 * moments.deviation * scatterShift(depth), a, c);
                    const float squares = moments.mean * moments.mean + moments.deviation * moments.deviation - 0.5;
                    light = clamp(s.light + s.curvature * (centre[r] - e[r] + kLog2e * squares) +
                                      (s.slope.x + float(p) * s.slope.y) * inverse_length[p] * (closest + q / k),
                                  0, 1);
                }
                const float opaque_part = opacity(depth);
                add(p, s.albedo, opaque_part, opaque_part * light);
            }
        }
    }
}
