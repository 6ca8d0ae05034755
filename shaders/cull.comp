#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Culling, per eye: lists the particles that are in the picture, with keys that sort them far to near. The key is the
// distance of a particle's centre from the eye, or from the middle between both eyes of a stereo viewer.
#include "shaders/shared/types.h"
#include "shaders/shared/sort_key.h"
#include "shaders/shared/support.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) uniform EyeBlock { Eye eye; };
layout(scalar, binding = 2) readonly buffer Particles { Particle particles[]; };
layout(scalar, binding = 3) writeonly buffer Keys { uint keys[]; };
layout(scalar, binding = 4) writeonly buffer Values { uint values[]; };
layout(scalar, binding = 5) buffer Arguments { DrawArguments arguments; };

layout(scalar, binding = 6) uniform OtherBlock { Eye other; }; // the other eye of a stereo viewer, otherwise this eye

layout(push_constant, scalar) uniform Push {
    uint full_support; // 1: proxies are spheres around the full Gaussian, 0: tetrahedra
} push;

#include "shaders/lib/frustum.glsl"

bool isVisible(Eye e, vec3 centre, float radius) {
    const vec3 c = centre - e.position;
    const float depth = -dot(e.back, c);
    if (!(depth + radius > e.near_depth)) return false;
    const vec2 at = vec2(dot(e.right, c), -dot(e.up, c)), lo = pictureCorner(e), hi = lo + 2 * pictureHalf(e);
    // distance to the side planes, whose normals are (cos, -sin) of the angle from the view axis
    return all(lessThan((depth * lo - at) * inversesqrt(1 + lo * lo), vec2(radius))) &&
           all(lessThan((at - depth * hi) * inversesqrt(1 + hi * hi), vec2(radius)));
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= tick.particle_count) return;
    const Particle p = particles[i];
    const float support = supportRadius(p.sigma_t, p.scale * tick.falloff, tick.cut);
    const float radius = push.full_support != 0 ? support : support < 0 ? support : p.scale;
    uint key = kDropped;
    if (radius > 0 && (isVisible(eye, p.centre, radius) || isVisible(other, p.centre, radius))) {
        key = sortKeyFarToNear(length(p.centre - 0.5 * (eye.position + other.position)));
        if (key != kDropped) atomicAdd(arguments.instance_count, 1);
    }
    keys[i] = key;
    values[i] = i;
}
