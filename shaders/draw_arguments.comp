#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Writes the arguments of indirect draws from the number of visible particles.
#include "shaders/shared/types.h"

layout(local_size_x = 1) in;

layout(scalar) buffer Arguments { DrawArguments arguments; };

layout(push_constant, scalar) uniform Push {
    uint vertices;            // per particle, for the draw without mesh shaders
    uint particles_per_group; // for the mesh draw
} push;

void main() {
    arguments.vertex_count = push.vertices;
    arguments.groups_x = (arguments.instance_count + push.particles_per_group - 1) / push.particles_per_group;
    arguments.groups_y = 1;
    arguments.groups_z = 1;
}
