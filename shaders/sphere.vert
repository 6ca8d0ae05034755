#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Sphere proxies (seed 000 section 6.2): an instance is a particle, drawn as the octagon around the silhouette of the sphere
// beyond which the Gaussian's column depth is below the cut. Where the sphere comes near the eye the octagon is the whole picture.
#include "shaders/shared/types.h"
#include "shaders/shared/support.h"

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) uniform EyeBlock { Eye eye; };
layout(scalar, binding = 2) readonly buffer Particles { Particle particles[]; };
layout(scalar, binding = 4) readonly buffer Order { uint order[]; };

layout(location = 0) flat out vec4 centre_radius;
layout(location = 1) flat out vec4 albedo_sigma;
layout(location = 2) flat out float k;

// Octagon of inradius 1 as a strip, and the picture's rectangle in its place.
const float kOut = 1.0, kIn = 0.414213562;
const vec2 kOctagon[8] = vec2[](vec2(kOut, kIn), vec2(kOut, -kIn), vec2(kIn, kOut), vec2(kIn, -kOut), vec2(-kIn, kOut), vec2(-kIn, -kOut),
                                vec2(-kOut, kIn), vec2(-kOut, -kIn));
const vec2 kPicture[8] = vec2[](vec2(1, 1), vec2(1, -1), vec2(-1, 1), vec2(-1, -1), vec2(-1, -1), vec2(-1, -1), vec2(-1, -1), vec2(-1, -1));

void main() {
    const Particle p = particles[order[gl_InstanceIndex]];
    const vec3 c = p.centre - eye.position;
    const float u = p.scale * tick.falloff;
    const float radius = supportRadius(p.sigma_t, u, tick.cut);
    centre_radius = vec4(c, radius);
    albedo_sigma = vec4(p.albedo, p.sigma_t);
    k = 7.0710678118655 / u;

    const vec3 v = vec3(dot(eye.right, c), dot(eye.up, c), -dot(eye.back, c));
    const float d2 = dot(v, v);
    gl_Position = vec4(kPicture[gl_VertexIndex], 0, 1);
    if (d2 > radius * radius * 1.0002) {
        // The cone from the eye touches the sphere in a circle of this centre and radius.
        const float inside = radius * radius / d2;
        const vec3 middle = v * (1 - inside);
        const float r = radius * sqrt(1 - inside);
        const vec3 axis = v * inversesqrt(d2);
        const vec3 side = normalize(abs(axis.x) < 0.7 ? vec3(0, axis.z, -axis.y) : vec3(-axis.z, 0, axis.x));
        const vec3 other = cross(axis, side);
        if (middle.z - r * 1.0823922 > eye.near_depth) { // every corner is in front
            const vec3 corner = middle + r * (kOctagon[gl_VertexIndex].x * side + kOctagon[gl_VertexIndex].y * other);
            gl_Position = vec4(corner.x / (corner.z * eye.tan_x), -corner.y / (corner.z * eye.tan_y), 0, 1);
        }
    }
}
