#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Local light depth of a volume, once a tick: its optical depth from a point or a spot to some distances in many
// directions (LocalLight::volume). A lane is a direction.
#include "shaders/shared/constants.h"
#include "shaders/shared/field.h"
#include "shaders/shared/types.h"

layout(local_size_x = 8, local_size_y = 8) in;

#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Nodes { float nodes[]; };
layout(scalar) readonly buffer Marks { uint marks[]; };
layout(scalar) writeonly buffer LightDepths { float light_depths[]; }; // of each volume [y][x][shell]

layout(push_constant, scalar) uniform Push { MediumGrid medium; } push;

#include "shaders/lib/grid_marks.glsl"
#include "shaders/lib/extinction_nodes.glsl"
#include "shaders/lib/light_directions.glsl"
#include "shaders/lib/node_depth.glsl"

void main() {
    const LocalLight light = local_lights[gl_WorkGroupID.z];
    const uvec2 node = gl_GlobalInvocationID.xy;
    if (light.volume == kNoVolume || any(greaterThanEqual(node, uvec2(light.volume_side)))) return;
    const vec3 w = fromLightSquare(light, vec2(node) * (2 / float(light.volume_side - 1)) - 1);
    const uint at = light.volume + (node.y * light.volume_side + node.x) * light.volume_shells;
    float depth = 0; // the first distance stands for the light itself: nothing lies between
    light_depths[at] = 0;
    for (uint s = 1; s < light.volume_shells; ++s) {
        const vec3 from = light.position + (light.volume_near + float(s - 1) * light.volume_step) * w;
        depth += depthThroughNodes(from, from + light.volume_step * w) / tick.extinction;
        light_depths[at + s] = depth;
    }
}
