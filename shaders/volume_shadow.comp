#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Volumetric shadow map of a volume: the optical depth between the light and every texel of every plane. A lane is a
// column of texels: it walks away from the light once.
#include "shaders/shared/constants.h"
#include "shaders/shared/field.h"
#include "shaders/shared/types.h"

layout(local_size_x = 8, local_size_y = 8) in;

#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Nodes { float nodes[]; };
layout(scalar) readonly buffer Marks { uint marks[]; };
layout(scalar) writeonly buffer Texels { vec4 texels[]; }; // [layer][row of the band][column]

layout(push_constant, scalar) uniform Push {
    MediumGrid medium;
    uint first_row, rows; // of texels in this band of the map
    uint layers;          // of the map
} push;

#include "shaders/lib/grid_marks.glsl"
#include "shaders/lib/extinction_nodes.glsl"
#include "shaders/lib/node_depth.glsl"

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    const uint columns = tick.map.texels.x, rows = min(push.rows, tick.map.texels.y - push.first_row);
    if (at.x >= columns || at.y >= rows) return;
    const vec2 part = (vec2(at) + vec2(0.5, float(push.first_row) + 0.5)) / vec2(tick.map.texels);
    const vec2 across = mix(tick.map.lo.xy, tick.map.hi.xy, part);
    vec3 from = across.x * tick.map.x + across.y * tick.map.y + tick.map.hi.z * tick.sun.to_light;
    const vec3 step = (tick.map.lo.z - tick.map.hi.z) / float(tick.map.slices - 1) * tick.sun.to_light;
    float depth = 0;
    for (uint layer = 0; layer < push.layers; ++layer) {
        vec4 planes = vec4(depth, 0, 0, 0);
        for (uint j = 1; j < 4; ++j) {
            // The map holds what is without the hue's part of the extinction, which its readers know.
            depth += depthThroughNodes(from, from + step) / tick.extinction;
            from += step;
            planes[j] = depth;
        }
        texels[(layer * rows + at.y) * columns + at.x] = planes;
    }
}
