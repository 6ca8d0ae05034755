#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Looks places up in the shared shadow grid: the lit part, or -1 outside.
#include "shaders/shared/shadow_grid.h"

layout(local_size_x = 64) in;

layout(scalar) uniform GridBlock { ShadowGridBlock shadow_grid; };
layout(scalar) readonly buffer Voxels { uint shadow_voxels[]; };
layout(scalar) readonly buffer Places { vec3 places[]; };
layout(scalar) writeonly buffer Lit { float lit[]; };

layout(push_constant, scalar) uniform Push { uint count, slot; } push;

#include "shaders/lib/shadow_grid.glsl"

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    bool known;
    const float value = litInGrid(push.slot, places[i], known);
    lit[i] = known ? value : -1;
}
