#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Sprites: an instance is a particle's picture, a square across the view axis. Both eyes of a head have the same axes.
#include "shaders/shared/types.h"
#include "shaders/shared/splat.h"

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer ParticleLights { ParticleLight lights[]; };
layout(scalar) readonly buffer Order { uint order[]; };

layout(location = 0) out vec2 at;                // -1 ... 1, to the right and up
layout(location = 1) flat out vec4 albedo_light; // the part of the sun's light that arrives
layout(location = 2) flat out vec3 depth_radius; // view depth of the centre and radius of the ball, m; optical depth
layout(location = 3) flat out uint particle;

#include "shaders/lib/frustum.glsl"
#include "shaders/lib/sprite.glsl"

void main() {
    particle = order[gl_InstanceIndex];
    const Particle p = particles[particle];
    const vec3 c = p.centre - eye.position;
    const vec3 v = vec3(dot(eye.right, c), dot(eye.up, c), -dot(eye.back, c));
    const float radius = tick.balls.radius * p.scale, reach = push.size * radius;
    at = 2 * vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) - 1;
    albedo_light = vec4(p.albedo, push.lit != 0 ? lights[particle].transmittance : 1);
    const float depth = tick.balls.sigma_t * radius * (4.0 / 3); // of the mean chord, spread evenly over the disc
    // The part that is before the eye: a ball that comes near fades, it does not vanish at once.
    const float before = clamp((v.z - eye.near_depth) / radius, 0, 1);
    // Pi / 4: a disc over the square around it. Maps have depths over their mean.
    depth_radius = vec3(v.z, radius, tick.extinction * depth * before * (0.785398163 / (push.size * push.size)));
    const vec2 corner = v.xy + reach * at;
    gl_Position = before > 0 ? vec4(toDevice(vec2(corner.x, -corner.y) / v.z), 0, 1) : vec4(-2, -2, 0, 1);
}
