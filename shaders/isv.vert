#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Interval shading for devices without mesh shaders: an instance is a particle, its 12 vertices are 4 triangles of
// the fan.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"

#include "shaders/blocks/axes.glsl"
#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Order { uint order[]; };

#include "shaders/lib/interval_proxy.glsl"

layout(location = 0) flat out vec4 centre_scale;
layout(location = 1) flat out vec4 albedo_sigma;
layout(location = 2) out vec2 inverse_depth;
layout(location = 3) flat out uint particle_clipped; // the lowest bit: IntervalProxy::clipped

void main() {
    const uint particle = order[gl_InstanceIndex];
    const Particle p = particles[particle];
    const vec3 c = p.centre - eye.position;
    mat3 own = mat3(1);
    if (kEllipsoids) own = mat3(axes[particle].a, axes[particle].b, axes[particle].c);
    const IntervalProxy proxy = intervalProxy(c, p.scale, tetrahedronAxes(particle, own));
    const uint triangle = gl_VertexIndex / 3;
    const uint i = triangle < proxy.ring ? fanVertex(triangle, gl_VertexIndex % 3, proxy.ring) : 0;
    gl_Position = vec4(proxy.ndc[i], 0, 1);
    centre_scale = vec4(c, p.scale);
    albedo_sigma = vec4(p.albedo, tick.extinction * p.sigma_t);
    inverse_depth = proxy.inverse_depth[i];
    particle_clipped = particle << 1 | uint(proxy.clipped);
}
