#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Shade, for views with band-limited pictures: the displayed colour of every kStep-th pixel, input of present.comp. A
// lane is a node.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const bool kHasOpaque = false, kHasCasters = false;
layout(constant_id = kIdHasLobe) const bool kHasLobe = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;
layout(constant_id = kIdRate) const uint kRate = 2;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;
layout(constant_id = kIdScattering) const uint kScatteringModel = 0;

layout(scalar) writeonly buffer Shaded { uint shaded[]; }; // lib/shaded.glsl
layout(scalar) readonly buffer Field { float field[]; };   // shared/field.h

#include "shaders/lib/eye.glsl"
#include "shaders/lib/sky.glsl"
#include "shaders/lib/display.glsl"
#include "shaders/lib/planes.glsl"
#define BRUME_WRITES_SHADED
#include "shaders/lib/shaded.glsl"
#include "shaders/lib/medium_run.glsl"
#include "shaders/lib/spread.glsl"

void main() {
    const uvec3 own = spreadInvocation();
    enterView(own.z);
    const View view = views[own.z];
    const uvec2 node = own.xy, nodes = shadedNodes(view.end - view.first);
    if (any(greaterThanEqual(node, nodes))) return;
    const ivec2 pixel = (ivec2(node) - 1) * int(kStep) + ivec2(0, view.first);
    const vec3 dir = rayDirection(vec2(pixel) + 0.5);
    const MediumRun run = mediumRun(pixel);
    float ray[kMostFieldQuantities];
    wholeRay(run, fieldAcross(pixel.x), dir, kEndless, ray);
    const vec3 shown = displayed(mediumOver(vec4(skyRadiance(normalize(dir)), 1), dir, ray, vec3(1)).rgb);
    writeShaded(view.shaded, node, nodes, shown);
}
