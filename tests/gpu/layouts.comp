#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Writes the first word of every member of the shared structs, so that the CPU can tell at which offset the shader
// sees it.
#include "shaders/shared/types.h"

layout(local_size_x = 1) in;

layout(scalar) uniform TickBlock { Tick tick; };
layout(scalar) uniform EyeBlock { Eye eye; };
layout(scalar) readonly buffer Particles { Particle particles[]; };
layout(scalar) readonly buffer Objects { Opaque objects[]; };
layout(scalar) readonly buffer LightParticles { LightParticle light_particles[]; };
layout(scalar) readonly buffer Arguments { DrawArguments arguments; };
layout(scalar) readonly buffer Views { View views[]; };
layout(scalar) writeonly buffer Words { uint words[]; };

uint at = 0;
void put(uint word) { words[at++] = word; }
void put(float word) { words[at++] = floatBitsToUint(word); }

void main() {
    put(tick.sun.to_light.x);
    put(tick.falloff);
    put(tick.map.x.x);
    put(tick.phase.part);
    put(tick.map.y.x);
    put(tick.phase.second);
    put(tick.sun.irradiance.x);
    put(tick.cut);
    put(tick.ambient.x);
    put(tick.particle_count);
    put(tick.map.lo.x);
    put(tick.map.slices);
    put(tick.map.hi.x);
    put(tick.map.opaque_size);
    put(tick.map.opaque_lo.x);
    put(tick.map.opaque_hi.x);
    put(tick.map.texels.x);
    put(tick.opaque_count);
    put(tick.sky_zenith.x);
    put(tick.sky_horizon.x);
    put(tick.haze);
    put(tick.map.u.x);
    put(tick.map.v.x);
    put(tick.map.plane.x);
    put(eye.position.x);
    put(eye.near_depth);
    put(eye.right.x);
    put(eye.tan_x);
    put(eye.up.x);
    put(eye.tan_y);
    put(eye.back.x);
    put(eye.exposure); put(eye.size.x); put(eye.filmic); put(eye.ray.x); put(eye.ray_right.x); put(eye.ray_down.x);
    put(particles[1].centre.x); put(particles[1].scale); put(particles[1].albedo.x); put(particles[1].sigma_t);
    put(objects[1].centre.x);
    put(objects[1].kind);
    put(objects[1].half_size.x);
    put(objects[1].yaw_cos);
    put(objects[1].albedo.x);
    put(objects[1].yaw_sin);
    put(light_particles[1].at.x); put(light_particles[1].k.x); put(light_particles[1].reach);
    put(views[1].eye.position.x);
    put(views[1].map_rays.eye.x);
    put(views[1].map_rays.ray.x);
    put(views[1].map_rays.right.x);
    put(views[1].map_rays.down.x);
    put(views[1].grid.nodes.x); put(views[1].grid.margin); put(views[1].grid.first_row); put(views[1].grid.rate);
    put(views[1].grid.depth);
    put(views[1].grid.thickness);
    put(views[1].grid.slabs);
    put(views[1].grid.sheet);
    put(views[1].grid.lines.x);
    put(views[1].grid.caster_words);
    put(views[1].grid.albedo.x);
    put(views[1].first);
    put(views[1].end);
    put(views[1].planes);
    put(views[1].members); put(views[1].bins); put(views[1].added); put(views[1].field); put(views[1].shaded);
    put(arguments.vertex_count);
    put(arguments.instance_count);
    put(arguments.first_vertex);
    put(arguments.first_instance);
    put(arguments.groups_x); put(arguments.groups_y); put(arguments.groups_z);
}
