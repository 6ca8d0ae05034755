#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Method `tiles`, first pass, per eye: turns the visible particles into splats, functions of the pixel, near to far.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/splat.h"
#include "shaders/shared/support.h"
#include "shaders/shared/transmittance.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/axes.glsl"
#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Order { uint order[]; }; // far to near
layout(scalar) readonly buffer Arguments { DrawArguments arguments; };
layout(scalar) readonly buffer ParticleLights { ParticleLight lights[]; };
layout(scalar) writeonly buffer Cones { SplatCone cones[]; };
layout(scalar) writeonly buffer Splats { Splat splats[]; };
layout(scalar) writeonly buffer Ways { SplatWay ways[]; }; // of ellipsoids

layout(constant_id = kIdCached) const bool kCached = true;

// v . d as a function of the pixel; d: ray direction of unit view depth.
vec3 affine(vec3 v) { return vec3(dot(v, eye.ray), dot(v, eye.ray_right), dot(v, eye.ray_down)); }

EllipsoidAxes own; // of the lane's particle

// The vector whose product with any d is that of `v` with d in units of the semi-axes.
vec3 fromSemiAxes(vec3 v) {
    if (!kEllipsoids) return v;
    return v.x / dot(own.a, own.a) * own.a + v.y / dot(own.b, own.b) * own.b + v.z / dot(own.c, own.c) * own.c;
}

void main() {
    const uint j = gl_GlobalInvocationID.x, visible = arguments.instance_count;
    if (j >= visible) return;
    const uint i = order[visible - 1 - j];
    const Particle p = particles[i];
    const vec3 c = p.centre - eye.position;
    const float u = p.scale * tick.falloff, distance = length(c);
    const vec3 axis = distance > 0 ? c / distance : -eye.back;
    // All in units of the semi-axes: to the centre, and two directions of the picture.
    vec3 in_c = c, right = eye.right, upward = eye.up;
    if (kEllipsoids) {
        own = axes[i];
        in_c = inSemiAxes(c, own.a, own.b, own.c);
        right = normalize(inSemiAxes(right, own.a, own.b, own.c));
        upward = inSemiAxes(upward, own.a, own.b, own.c);
        ways[j] = SplatWay(affine(own.a / dot(own.a, own.a)), affine(own.b / dot(own.b, own.b)),
                           affine(own.c / dot(own.c, own.c)));
    }
    const float in_distance = length(in_c);
    const vec3 in_axis = in_distance > 0 ? in_c / in_distance : -eye.back;
    // Two axes across the line of sight: upward in the picture, so that it is constant along a row, and sideways.
    const vec3 over = cross(right, in_axis);
    const vec3 up = dot(over, over) > 1e-6 ? normalize(over) : normalize(upward - dot(upward, in_axis) * in_axis);

    Splat splat;
    splat.k = gaussianK(p.scale, tick.falloff);
    splat.radius = supportRadius(p.sigma_t, u, tick.cut);
    splat.nearest = distance - splat.radius;
    splat.across_x = affine(fromSemiAxes(splat.k * in_distance * 1.2011224 * cross(up, in_axis)));
    splat.across_y = affine(fromSemiAxes(splat.k * in_distance * 1.2011224 * up)).xz;
    splat.along = affine(fromSemiAxes(in_c));
    splat.albedo = p.albedo;
    splat.log_line = log2(max(lineDepth(tick.extinction * p.sigma_t, splat.k, 1.0), 1e-30));
    splat.slope = vec3(0);
    splat.light = kLookUp;
    splat.curvature = 0;
    if (kCached) {
        const ParticleLight light = lights[i];
        splat.slope = affine(light.gradient);
        splat.curvature = light.curvature;
        if (light.transmittance != kLookUp)
            splat.light = light.transmittance + 0.5 * light.curvature - dot(light.gradient, c);
    }
    const float sine = min(splat.radius / max(distance, 1e-30), 1.0), cosine = sqrt(max(1 - sine * sine, 0));
    splat.chord = splat.nearest > 0 ? sine * sqrt(2 / (1 + cosine)) + 1e-6 : 2; // 1e-6: rounding of directions
    splats[j] = splat;
    cones[j] = SplatCone(axis, splat.chord);
}
