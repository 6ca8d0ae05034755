#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Pictures of a view's layers with depth (shared/depth_layers.h). A lane makes four neighbouring nodes of a layer. Its
// colour is what it would send to the eye with nothing in front.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdHasLobe) const bool kHasLobe = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;
layout(constant_id = kIdRate) const uint kRate = 1;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;
layout(constant_id = kIdScattering) const uint kScatteringModel = 0;

#include "shaders/blocks/tick.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(scalar) writeonly buffer Planes { uint planes[]; };
layout(scalar) readonly buffer Field { float field[]; };
layout(scalar) readonly buffer Layered { float layered[]; };
layout(scalar) readonly buffer Sunlit { vec3 sunlit[]; };         // written by shafts.comp
layout(scalar) readonly buffer LitByLocalLights { vec3 lit[]; }; // written by local_light.comp

#include "shaders/lib/eye.glsl"
#include "shaders/lib/sky.glsl"
#include "shaders/lib/display.glsl"
#include "shaders/lib/planes.glsl"
#include "shaders/lib/medium_run.glsl"

// Up to the end of layer `count` - 1 at a node; without a layer all is 0. Returns the integral of depth over the last.
float quantitiesUpTo(uint count, uvec2 node, out float sum[kMostFieldQuantities]) {
    const uint apart = layers.nodes.x * layers.nodes.y, quantities = fieldQuantities();
    for (uint q = 0; q < quantities; ++q) sum[q] = 0;
    if (count == 0) return 0;
    const uint from = layers.held + (count - 1) * (quantities + 1) * apart + node.y * layers.nodes.x + node.x;
    for (uint q = 0; q < quantities; ++q) sum[q] = isHeld(q) ? layered[from + q * apart] : 0;
    return layered[from + quantities * apart];
}

const float kLeastHidden = 1e-4; // a layer that hides less lies in the middle of the medium

void main() {
    enterView(0);
    const uint words = layerWords(layers.nodes.x), rows = layers.count * layers.rows;
    const uint word = gl_GlobalInvocationID.x, row = gl_GlobalInvocationID.y, layer = gl_GlobalInvocationID.z;
    if (word >= words || row >= layers.rows) return;
    // Bands of a picture have rows of their own. Those below a layer's last, up to whole blocks, repeat it.
    const uint y = min(row, layers.nodes.y - 1), ray_row = layers.first + y * layers.every;
    if (ray_row < grid.first_row || ray_row >= grid.first_row + grid.nodes.y) return;
    uint colours[3] = {0, 0, 0}, through = 0, depths = 0;
    for (uint i = 0; i < 4; ++i) {
        const uvec2 node = uvec2(min(4 * word + i, layers.nodes.x - 1), y);
        const uvec2 numbered = layers.first + node * layers.every;
        const vec2 at = (vec2(numbered) - float(grid.margin)) * float(grid.rate) + 0.5;
        const uvec2 pixel = uvec2(clamp(at, vec2(0), vec2(eye.size) - 1));
        const vec3 dir = rayDirection(at);
        if (layer == layers.count) {
            const vec3 rgb = displayed(skyRadiance(normalize(dir)));
            for (uint c = 0; c < 3; ++c) colours[c] |= byteOf(rgb[c], i);
            continue;
        }
        float before[kMostFieldQuantities], ray[kMostFieldQuantities], whole[kMostFieldQuantities];
        quantitiesUpTo(layer, node, before);
        const float moment = quantitiesUpTo(layer + 1, node, ray);
        quantitiesUpTo(layers.count, node, whole);
        const float hidden = opacity(ray[kFieldDepth]) - opacity(before[kFieldDepth]);
        const float depth_before = before[kFieldDepth], depth = max(ray[kFieldDepth] - depth_before, 0);
        for (uint q = 0; q < fieldQuantities(); ++q) ray[q] = max(ray[q] - before[q], 0);
        if (kHasFog) // fog stays with the surface
            for (uint c = 0; c < 3; ++c) {
                ray[fieldFog() + c] = 0;
                if (holdsGlow()) ray[fieldGlow() + c] = 0;
            }
        vec3 part = vec3(1);
        if (kHasCasters) part = sunlit[pixel.y * eye.size.x + pixel.x];
        vec3 light = mediumLight(dir, ray, hidden, part);
        if (kHasLocalLights && hidden > 0) { // of the whole ray: by what the layer hides
            float of_particles = 1;
            if (kHasFog) {
                const float end = kHasOpaque ? texelFetch(view_depth, ivec2(pixel), 0).r : kEndless;
                of_particles = whole[kFieldDepth] / max(whole[kFieldDepth] + fogBefore(dir, end), 1e-20);
            }
            light += lit[pixel.y * eye.size.x + pixel.x] * (of_particles * hidden / opacity(whole[kFieldDepth]));
        }
        const vec3 rgb = displayed(light * exp(min(depth_before, 80)));
        for (uint c = 0; c < 3; ++c) colours[c] |= byteOf(rgb[c], i);
        through |= byteOf(255 * exp(-depth), i);
        const float middle = 0.5 * (grid.depth + farDepth());
        const float mean = (moment + kLeastHidden * middle) / (max(hidden, 0) + kLeastHidden);
        depths |= byteOf(depthByte(mean, layers.near, layers.far, 255), i);
    }
    const uint at = (layer * layers.rows + row) * words + word;
    for (uint c = 0; c < 3; ++c) planes[layers.colours + c * layers.blocks * layers.rows * words + at] = colours[c];
    if (layer == layers.count) return;
    planes[layers.data + at] = through;
    planes[layers.data + rows * words + at] = depths;
}
