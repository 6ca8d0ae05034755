#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Per viewer: which particles can be seen, and the key that sorts them far to near by the distance of their centres.
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

layout(push_constant, scalar) uniform Push {
    uint full_support; // 1: proxies are spheres around the full Gaussian, 0: tetrahedra
} push;

#include "shaders/lib/frustum.glsl"

bool isVisible(vec3 c, float radius) {
    const float depth = -dot(eye.back, c);
    if (!(depth + radius > eye.near_depth)) return false;
    const vec2 at = vec2(dot(eye.right, c), -dot(eye.up, c)), lo = pictureCorner(), hi = lo + 2 * pictureHalf();
    // distance to the side planes, whose normals are (cos, -sin) of the angle from the view axis
    return all(lessThan((depth * lo - at) * inversesqrt(1 + lo * lo), vec2(radius))) &&
           all(lessThan((at - depth * hi) * inversesqrt(1 + hi * hi), vec2(radius)));
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= tick.particle_count) return;
    const Particle p = particles[i];
    const vec3 c = p.centre - eye.position;
    const float support = supportRadius(p.sigma_t, p.scale * tick.falloff, tick.cut);
    const float radius = push.full_support != 0 ? support : support < 0 ? support : p.scale;
    uint key = kDropped;
    if (radius > 0 && isVisible(c, radius)) {
        key = sortKeyFarToNear(length(c));
        if (key != kDropped) atomicAdd(arguments.instance_count, 1);
    }
    keys[i] = key;
    values[i] = i;
}
