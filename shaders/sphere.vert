#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Sphere proxies (seed 000 section 6.2): an instance is a particle. It is drawn as the octagon around the silhouette
// of a sphere; on lines outside the sphere, the Gaussian's optical depth is below the cut. If the octagon would reach
// behind the eye, the sphere's bounding rectangle is drawn.
#include "shaders/shared/types.h"
#include "shaders/shared/support.h"

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Order { uint order[]; };

layout(location = 0) flat out vec4 centre_radius;
layout(location = 1) flat out vec4 albedo_sigma;
layout(location = 2) flat out float k;

#include "shaders/lib/frustum.glsl"

// Octagon of inradius 1 as a strip; a rectangle as a strip.
const float kOut = 1.0, kIn = 0.414213562;
const vec2 kOctagon[8] = vec2[](vec2(kOut, kIn), vec2(kOut, -kIn), vec2(kIn, kOut), vec2(kIn, -kOut), vec2(-kIn, kOut),
                                vec2(-kIn, -kOut), vec2(-kOut, kIn), vec2(-kOut, -kIn));
const vec2 kRectangle[8] =
    vec2[](vec2(1, 1), vec2(1, 0), vec2(0, 1), vec2(0, 0), vec2(0, 0), vec2(0, 0), vec2(0, 0), vec2(0, 0));

// Range of slopes (across / depth) of the part of a sphere in front of the near plane, in the plane of `across` and
// depth. An end is the tangent from the eye, or the sphere's cut with the near plane if the tangent touches it behind
// that plane.
vec2 slopes(float across, float depth, float radius) {
    const float d2 = across * across + depth * depth, tangent2 = d2 - radius * radius;
    const float cut = sqrt(max(radius * radius - (eye.near_depth - depth) * (eye.near_depth - depth), 0));
    const float cosine = sqrt(max(tangent2, 0) / d2), sine = radius * inversesqrt(d2);
    vec2 bounds;
    for (int side = 0; side < 2; ++side) {
        const float turn = side == 0 ? sine : -sine;
        const float touch_across = cosine * across - turn * depth, touch_depth = cosine * depth + turn * across;
        const bool in_front = tangent2 > 0 && cosine * touch_depth > eye.near_depth;
        bounds[side] = in_front ? touch_across / touch_depth : (across + (side == 0 ? -cut : cut)) / eye.near_depth;
    }
    return bounds;
}

void main() {
    const Particle p = particles[order[gl_InstanceIndex]];
    const vec3 c = p.centre - eye.position;
    const float u = p.scale * tick.falloff;
    const float radius = supportRadius(p.sigma_t, u, tick.cut);
    centre_radius = vec4(c, radius);
    albedo_sigma = vec4(p.albedo, tick.extinction * p.sigma_t);
    k = 7.0710678118655 / u;

    const vec3 v = vec3(dot(eye.right, c), dot(eye.up, c), -dot(eye.back, c));
    const float d2 = dot(v, v);
    // The cone from the eye touches the sphere in a circle of this centre and radius.
    const float inside = min(radius * radius / d2, 1.0);
    const vec3 middle = v * (1 - inside);
    const float r = radius * sqrt(1 - inside);
    if (middle.z - r * 1.0823922 > eye.near_depth) { // every corner of the octagon around it is in front
        const vec3 axis = v * inversesqrt(d2);
        const vec3 side = normalize(abs(axis.x) < 0.7 ? vec3(0, axis.z, -axis.y) : vec3(-axis.z, 0, axis.x));
        const vec3 corner =
            middle + r * (kOctagon[gl_VertexIndex].x * side + kOctagon[gl_VertexIndex].y * cross(axis, side));
        gl_Position = vec4(toDevice(vec2(corner.x, -corner.y) / corner.z), 0, 1);
    } else {
        const vec2 x = slopes(v.x, v.z, radius), y = slopes(-v.y, v.z, radius);
        const vec2 lo = max(toDevice(vec2(x.x, y.x)), -1.01), hi = min(toDevice(vec2(x.y, y.y)), 1.01);
        gl_Position = vec4(mix(lo, hi, kRectangle[gl_VertexIndex]), 0, 1);
    }
}
