#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Shade for a picture that was drawn at every kStep-th pixel: the displayed colour of these pixels, input of
// present.comp. A lane is a node.
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f) readonly uniform image2D radiance;         // one pixel per node
layout(scalar) writeonly buffer Shaded { uint shaded[]; }; // lib/shaded.glsl

#include "shaders/lib/display.glsl"
#include "shaders/lib/planes.glsl"
#define BRUME_WRITES_SHADED
#include "shaders/lib/shaded.glsl"

void main() {
    enterView(0);
    const uvec2 node = gl_GlobalInvocationID.xy, nodes = shadedNodes(views[0].end - views[0].first);
    if (any(greaterThanEqual(node, nodes))) return;
    writeShaded(views[0].shaded, node, nodes, displayed(imageLoad(radiance, ivec2(node)).rgb));
}
