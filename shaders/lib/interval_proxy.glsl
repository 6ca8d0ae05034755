// Interval shading (seed 000 section 2.3, after Tricard 2024): a tetrahedron as a fan of 3 or 4 screen triangles
// around one inner point. Vertices carry the inverse view depths of the near and the far side. Inverse view depth
// (1/w) is linear in screen space; the seed's w/z is no view depth. Include after `eye` is declared.

struct IntervalProxy {
    vec2 ndc[5];           // 0: the inner point, 1 ... ring: around it
    vec2 inverse_depth[5]; // near side (the larger), far side
    uint ring;             // 3 or 4 triangles; 0: nothing to draw (edge-on, zero volume, behind the near plane)
    // True: crosses the near plane. The fan is a bounding rectangle, the interval comes from the face planes.
    bool clipped;
};

// Vertices of the particle's regular tetrahedron relative to its centre, for scale 1.
const vec3 kTetrahedron[4] =
    vec3[](vec3(0.57735026919), vec3(0.57735026919, -0.57735026919, -0.57735026919),
           vec3(-0.57735026919, 0.57735026919, -0.57735026919), vec3(-0.57735026919, -0.57735026919, 0.57735026919));

layout(constant_id = kIdTurned) const bool kTurned = false;
layout(constant_id = kIdDropsNear) const bool kDropsNear = false;

#include "shaders/lib/frustum.glsl"
#include "shaders/shared/orientation.h"

vec3 toView(vec3 c) { // clip x, y, w
    precise float depth = -dot(eye.back, c);
    precise vec2 at = (vec2(dot(eye.right, c), -dot(eye.up, c)) - depth * pictureMiddle()) / pictureHalf();
    return vec3(at, depth);
}

float twiceArea(vec2 a, vec2 b, vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// A rectangle around the part of a tetrahedron in front of the near plane.
IntervalProxy clippedProxy(vec3 v[4]) {
    IntervalProxy proxy;
    proxy.clipped = true;
    proxy.ring = 0;
    vec2 lo = vec2(1e30), hi = vec2(-1e30);
    for (uint i = 0; i < 4; ++i) {
        if (v[i].z >= eye.near_depth) {
            lo = min(lo, v[i].xy / v[i].z);
            hi = max(hi, v[i].xy / v[i].z);
        }
        for (uint j = i + 1; j < 4; ++j) {
            if ((v[i].z < eye.near_depth) == (v[j].z < eye.near_depth)) continue;
            const vec2 cut = mix(v[i].xy, v[j].xy, (eye.near_depth - v[i].z) / (v[j].z - v[i].z)) / eye.near_depth;
            lo = min(lo, cut);
            hi = max(hi, cut);
        }
    }
    lo = max(lo - 1e-4 * abs(lo) - 1e-4, vec2(-1.01));
    hi = min(hi + 1e-4 * abs(hi) + 1e-4, vec2(1.01));
    if (lo.x < hi.x && lo.y < hi.y) proxy.ring = 4;
    proxy.ndc = vec2[](0.5 * (lo + hi), lo, vec2(hi.x, lo.y), hi, vec2(lo.x, hi.y));
    for (uint i = 0; i < 5; ++i) proxy.inverse_depth[i] = vec2(1);
    return proxy;
}

// The axes of particle `number`'s tetrahedron from its semi-axes, of a ball the unit matrix.
mat3 tetrahedronAxes(uint number, mat3 axes) {
    if (!kTurned) return axes;
    const vec4 q = orientationOf(number);
    precise mat3 all = axes * mat3(turned(q, vec3(1, 0, 0)), turned(q, vec3(0, 1, 0)), turned(q, vec3(0, 0, 1)));
    return all;
}

// `c`: centre of the particle relative to the eye (m). `axes`: tetrahedronAxes().
IntervalProxy intervalProxy(vec3 c, float scale, mat3 axes) {
    vec3 v[4];
    bool crosses = false;
    if (kDropsNear && -dot(eye.back, c) - scale < eye.near_depth) { // seed 000 section 2.3.4
        IntervalProxy none;
        none.ring = 0;
        none.clipped = false;
        for (uint i = 0; i < 5; ++i) {
            none.ndc[i] = vec2(0);
            none.inverse_depth[i] = vec2(1);
        }
        return none;
    }
    for (uint i = 0; i < 4; ++i) {
        precise vec3 corner = c + scale * (axes * kTetrahedron[i]); // mesh and vertex shaders round alike
        v[i] = toView(corner);
        crosses = crosses || v[i].z < eye.near_depth;
    }
    if (crosses) return clippedProxy(v);

    IntervalProxy proxy;
    proxy.clipped = false;
    proxy.ring = 0;
    vec2 p[4];
    float inverse[4];
    for (uint i = 0; i < 4; ++i) {
        inverse[i] = 1 / v[i].z;
        p[i] = v[i].xy * inverse[i];
    }
    // Four points of a plane have one affine dependency. The points with positive and those with negative
    // coefficients span two sets that meet in one point (Radon): a vertex inside the triangle of the others, or the
    // crossing of a quadrilateral's diagonals.
    const float weight[4] = float[](twiceArea(p[1], p[2], p[3]), -twiceArea(p[0], p[2], p[3]),
                                    twiceArea(p[0], p[1], p[3]), -twiceArea(p[0], p[1], p[2]));
    uint above[4], below[4];
    uint aboves = 0, belows = 0;
    float sum_above = 0, sum_below = 0, inverse_above = 0, inverse_below = 0;
    vec2 inner = vec2(0);
    for (uint i = 0; i < 4; ++i) {
        if (weight[i] >= 0) {
            above[aboves++] = i;
            sum_above += weight[i];
            inverse_above += weight[i] * inverse[i];
            inner += weight[i] * p[i];
        } else {
            below[belows++] = i;
            sum_below += weight[i];
            inverse_below += weight[i] * inverse[i];
        }
    }
    for (uint i = 0; i < 5; ++i) {
        proxy.ndc[i] = vec2(0);
        proxy.inverse_depth[i] = vec2(1);
    }
    if (!(sum_above > 0) || !(sum_below < 0)) return proxy; // edge-on or not a number
    inverse_above /= sum_above;
    inverse_below /= sum_below;
    proxy.inverse_depth[0] = vec2(max(inverse_above, inverse_below), min(inverse_above, inverse_below));
    proxy.ndc[0] = aboves == 1 ? p[above[0]] : belows == 1 ? p[below[0]] : inner / sum_above;
    uint around[4];
    if (aboves == 2) {
        around = uint[](below[0], above[0], below[1], above[1]);
        proxy.ring = 4;
    } else {
        const bool inner_above = aboves == 1;
        for (uint i = 0; i < 3; ++i) around[i] = inner_above ? below[i] : above[i];
        around[3] = around[0];
        proxy.ring = 3;
    }
    for (uint i = 0; i < 4; ++i) {
        proxy.ndc[i + 1] = p[around[i]];
        proxy.inverse_depth[i + 1] = vec2(inverse[around[i]]);
    }
    return proxy;
}

// Index in the fan of corner 0 ... 2 of triangle `triangle`.
uint fanVertex(uint triangle, uint corner, uint ring) { return corner == 0 ? 0 : 1 + (triangle + corner - 1) % ring; }
