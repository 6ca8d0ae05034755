#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_basic : require
// Local light, per eye: radiance of the light of points and spots that the medium scatters toward the eye, up to the
// pixel's surface (lib/local_light_ray.glsl). A workgroup makes a tile of 16x16 pixels. With kStep it computes nodes,
// one pixel of 4x4. They hold the light of all lights but near ones, which every pixel computes. Other lights are
// computed where nodes do not tell the pixel: at edges, unless these are soft.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdRate) const uint kRate = 1;
layout(constant_id = kIdStep) const uint kStep = 1; // 1 or 4
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;

#include "shaders/blocks/view_depth.glsl"
layout(scalar) writeonly buffer LitByLocalLights { vec3 lit[]; }; // W/(m^2 sr), row by row
layout(scalar) readonly buffer Field { float field[]; }; // shared/field.h

#include "shaders/lib/eye.glsl"
#include "shaders/lib/slab_field.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"
#include "shaders/lib/point_shadow.glsl"
#include "shaders/lib/shadow_list.glsl"
#include "shaders/lib/local_light_ray.glsl"

const float kStraight = 0.02; // of the light
#include "shaders/lib/pixel_nodes.glsl"
#include "shaders/lib/spread.glsl"

shared uint any_is_needed; // 1: a light may reach the tile that rays do not hold

void main() {
    enterView(0);
    const bool soft_edges = grid.soft_edges != 0; // True: edges are smoothed over
    // gl_LocalInvocationIndex would be divided out anew behind each barrier.
    const uint lane = gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID;
    const uvec2 tile = spreadGroup().xy * kPixelTile + uvec2(0, views[0].first);
    const uvec2 end = uvec2(eye.size.x, views[0].end);
    const bool coarse = kStep > 1 && all(lessThan(tile + kPixelTile, end)); // True: all nodes are in the picture
    if (lane < lightWords()) near_lights[lane] = 0;
    if (lane == 0) any_is_near = any_is_needed = 0;
    barrier();
    // Bins of the tile's four corners hold all its pixels, and the nodes beyond them.
    for (uint i = lane; i < 4 * lightWords(); i += 64) {
        const uvec2 corner = tile + kPixelTile * uvec2(i & 1, i >> 1 & 1);
        if (isAnyNeeded(binOf(min(corner, eye.size - 1)), i / 4)) atomicOr(any_is_needed, 1);
    }
    barrier();
    if (any_is_needed == 0) {
        for (uint i = lane; i < kPixelTile * kPixelTile; i += 64) {
            const uvec2 pixel = tile + uvec2(i % kPixelTile, i / kPixelTile);
            if (all(lessThan(pixel, end))) lit[pixel.y * eye.size.x + pixel.x] = vec3(0);
        }
        return;
    }
    if (coarse && lane < kNodes * kNodes) findNearLights(tile + kStep * uvec2(lane % kNodes, lane / kNodes));
    barrier();
    [[dont_unroll]] for (uint part = 0; part < 5; ++part) { // the nodes, then all pixels, 8x8 at a time
        const bool nodes = part == 0;
        const uvec2 quarter = uvec2((part - 1) & 1, (part - 1) >> 1);
        const uvec2 in_tile = nodes ? kStep * uvec2(lane % kNodes, lane / kNodes) :
                                      8 * quarter + uvec2(lane % 8, lane / 8);
        const uvec2 pixel = tile + in_tile;
        const bool made = nodes ? coarse && lane < kNodes * kNodes : all(lessThan(pixel, end));
        float depth = 1;
        if (made) depth = texelFetch(view_depth, ivec2(pixel), 0).r;
        vec3 light = vec3(0);
        bool between = false; // True: the nodes tell the light
        if (!nodes && coarse) {
            between = isBetweenNodes(in_tile, 1 / depth, light);
            if (soft_edges && !between) between = isSmoothed(in_tile, 1 / depth, light);
            if (!between) light = vec3(0);
        }
        if (made) {
            if (!between || any_is_near != 0) light += ofPixel(pixel, depth, !nodes, !between);
            if (nodes) {
                node_value[lane] = light;
                node_inverse[lane] = 1 / depth;
            } else {
                lit[pixel.y * eye.size.x + pixel.x] = max(light, 0);
            }
        }
        if (nodes) barrier();
    }
}
