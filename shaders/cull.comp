#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Culling, per eye: lists the particles that are in the picture, with keys that sort them far to near. The key is the
// distance of a particle's centre from the eye, or from the middle between both eyes of a stereo viewer.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/sort_key.h"
#include "shaders/shared/support.h"

layout(local_size_x = 64) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true; // True: particles behind all surfaces are left out

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer Keys { uint keys[]; };
layout(scalar) writeonly buffer Values { uint values[]; };
layout(scalar) buffer Arguments { DrawArguments arguments; };

layout(scalar) uniform OtherBlock { Eye other; }; // the other eye of a stereo viewer, otherwise this eye
layout(scalar) readonly buffer Furthest { float furthest[]; }; // written by furthest_depths.comp

layout(push_constant, scalar) uniform Push {
    uint full_support; // 0: proxies are tetrahedra, 1: spheres around the full Gaussian, 2: evenly filled tetrahedra
    float sprite;      // > 0: proxies are sprites of this radius, per scale
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

const float kBehind = 1.001; // least distance of what is hidden, over that of the surfaces: rounding takes less

// True if the ball lies behind the surfaces of all tiles that its box in the picture meets. Precondition: it is visible
// but for them.
bool isHidden(vec3 centre, float radius) {
    const vec3 c = centre - eye.position;
    const float depth = -dot(eye.back, c), near = max(depth - radius, eye.near_depth), far = depth + radius;
    const vec2 at = vec2(dot(eye.right, c), -dot(eye.up, c)), lo = at - radius, hi = at + radius;
    const vec2 pixels = vec2(eye.size) / (2 * pictureHalf()); // per unit of slope
    const vec2 first = (min(lo / near, lo / far) - pictureCorner()) * pixels - 1, // a pixel more: rounding
               last = (max(hi / near, hi / far) - pictureCorner()) * pixels + 1;
    const uvec2 tiles = (eye.size + kPixelTile - 1) / kPixelTile;
    const uvec2 a = uvec2(clamp(first / float(kPixelTile), vec2(0), vec2(tiles - 1))),
                b = uvec2(clamp(last / float(kPixelTile), vec2(0), vec2(tiles - 1)));
    const float before = length(c) - radius; // distance of its nearest point
    bool hidden = true;
    for (uint y = a.y; y <= b.y && hidden; ++y)
        for (uint x = a.x; x <= b.x && hidden; ++x) hidden = before > kBehind * furthest[y * tiles.x + x];
    return hidden;
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= tick.particle_count) return;
    const Particle p = particles[i];
    const float support = supportRadius(p.sigma_t, p.scale * tick.falloff, tick.cut);
    const float radius = push.sprite > 0          ? push.sprite * p.scale
                         : push.full_support == 2 ? p.scale
                         : push.full_support == 1 || support < 0 ? support : p.scale;
    uint key = kDropped;
    bool drawn = radius > 0 && (isVisible(eye, p.centre, radius) || isVisible(other, p.centre, radius));
    if (kHasOpaque && drawn) drawn = !isHidden(p.centre, radius);
    if (drawn) {
        key = sortKeyFarToNear(length(p.centre - 0.5 * (eye.position + other.position)));
        if (key != kDropped) atomicAdd(arguments.instance_count, 1);
    }
    keys[i] = key;
    values[i] = i;
}
