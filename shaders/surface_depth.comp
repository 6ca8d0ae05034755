#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// View depth of each pixel's surface as a byte (shared/depth_layers.h). A lane makes four pixels.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

#include "shaders/blocks/view_depth.glsl"
layout(scalar) writeonly buffer Planes { uint planes[]; };

#include "shaders/lib/planes.glsl"

void main() {
    enterView(0);
    const uint words = lumaWords(), word = gl_GlobalInvocationID.x;
    const uint row = views[0].first + gl_GlobalInvocationID.y;
    if (word >= words || row >= views[0].end) return;
    uint depths = 0;
    for (uint i = 0; i < 4; ++i) {
        const float z = texelFetch(view_depth, ivec2(min(4 * word + i, eye.size.x - 1), row), 0).r;
        const float byte = z < kFarSurface ? 1 + depthByte(z, kNearSurface, kFarSurface, 253) : 255;
        depths |= byteOf(byte, i);
    }
    planes[layers.surface + row * words + word] = depths;
}
