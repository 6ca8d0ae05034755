#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Probe: the radiance that some pixels of one view have, for the server's own estimate of its error. A lane is a pixel.
// Rate, colours and step are no constants here: one program serves all ways to draw, since a CPU driver takes long to
// compile it.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 64) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdHasLobe) const bool kHasLobe = true;
layout(constant_id = kIdDrawn) const bool kDrawn = true;
const bool kHasAmbient = false; // the medium is compared without ambient light, unless it is drawn already

layout(push_constant) uniform Push { ProbePush push; };
#define kRate push.rate
#define kSunColours push.sun_colours
#define kAmbientColours push.ambient_colours
#define kMultipleColours push.multiple_colours
const uint kScatteringModel = 0; // and without what has scattered more than once

#include "shaders/blocks/tick.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(rgba32f) uniform readonly image2D radiance;
layout(scalar) readonly buffer Pixels { uvec2 pixels[]; };
layout(scalar) readonly buffer Field { float field[]; }; // shared/field.h
layout(scalar) readonly buffer Sunlit { vec3 sunlit[]; }; // written by shafts.comp
layout(scalar) buffer Values { vec4 values[]; };
layout(scalar) readonly buffer LitByLocalLights { vec3 lit[]; }; // written by local_light.comp

#include "shaders/lib/eye.glsl"
#include "shaders/lib/cubic.glsl"
#include "shaders/lib/medium_run.glsl"
#include "shaders/lib/medium_cut.glsl"

// From the pixels that were drawn, one of step x step: the first is one step up and left of the picture's first.
vec4 drawnAt(uvec2 pixel) {
    if (push.step == 1) return imageLoad(radiance, ivec2(pixel));
    const uvec2 node = pixel / push.step;
    const vec2 part = vec2(pixel % push.step) / float(push.step);
    const vec4 across = cubic(part.x), down = cubic(part.y);
    vec4 sum = vec4(0);
    for (uint j = 0; j < 4; ++j)
        for (uint i = 0; i < 4; ++i) sum += across[i] * down[j] * imageLoad(radiance, ivec2(node + uvec2(i, j)));
    return sum;
}

// The medium in front of a black background.
vec4 mediumAt(ivec2 pixel) {
    const vec3 dir = rayDirection(vec2(pixel) + 0.5);
    const MediumRun run = mediumRun(pixel);
    const vec4 across = fieldAcross(pixel.x);
    float ray[kMostFieldQuantities];
    const float end = kHasFog && kHasOpaque ? texelFetch(view_depth, pixel, 0).r : kEndless;
    wholeRay(run, across, dir, end, ray);
    if (kHasOpaque) {
        MediumCut cut = mediumCut();
        cutRay(cut, run, pixel, dir, across, ray);
    }
    for (uint c = 0; c < kMultipleColours; ++c) ray[fieldMultiple() + c] = 0;
    const uint at = uint(pixel.y) * eye.size.x + uint(pixel.x);
    vec4 medium = mediumOver(vec4(0, 0, 0, 1), dir, ray, kHasCasters ? sunlit[at] : vec3(1));
    if (kHasLocalLights) medium.rgb += lit[at];
    return medium;
}

void main() {
    enterView(0);
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    const uvec2 pixel = pixels[i];
    if (pixel.y < views[0].first || pixel.y >= views[0].end) return; // in another band of the picture
    const vec4 value = kDrawn ? drawnAt(pixel) : mediumAt(ivec2(pixel));
    if (tick.channels == kAllChannels) {
        values[i] = value;
        return;
    }
    // Red is among the first channels that are drawn. The transmittance is the mean of all channels'.
    vec4 sum = (tick.channels & 1) != 0 ? vec4(0) : values[i];
    for (uint c = 0; c < 3; ++c)
        if ((tick.channels >> c & 1) != 0) sum[c] = value[c], sum.a += value.a / 3;
    values[i] = sum;
}
