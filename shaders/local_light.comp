#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Local light, per eye: radiance of the light of points and spots that the medium scatters toward the eye, up to the
// pixel's surface (lib/local_light_ray.glsl). A workgroup makes a tile of 16x16 pixels. With kStep it computes one of
// 4x4, and others only where those do not tell them: at edges, and near lights.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdRate) const uint kRate = 1;
layout(constant_id = kIdStep) const uint kStep = 1; // 1 or 4
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 2) writeonly buffer Lit { vec3 lit[]; }; // W/(m^2 sr), row by row
layout(scalar, binding = 3) readonly buffer Lights { LocalLight local_lights[]; };
layout(scalar, binding = 4) readonly buffer Field { float field[]; }; // shared/field.h
layout(scalar, binding = 5) readonly buffer Objects { Opaque objects[]; };
layout(scalar, binding = 6) readonly buffer Bits { uint light_bits[]; };
layout(scalar, binding = 7) readonly buffer Depths { float light_depths[]; };
layout(binding = 8) uniform sampler2D view_depth;
layout(scalar, binding = 9) readonly buffer Nodes { ObjectNode object_nodes[]; };
layout(scalar, binding = 10) readonly buffer Triangles { Triangle triangles[]; };
layout(scalar, binding = 11) readonly buffer MeshNodes { ObjectNode mesh_nodes[]; };

#include "shaders/lib/eye.glsl"
#include "shaders/lib/slab_field.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"
#include "shaders/lib/point_shadow.glsl"
#include "shaders/lib/shadow_list.glsl"
#include "shaders/lib/local_light_ray.glsl"

// Of the cubic between nodes: most difference from straight lines, as a part of the largest value.
const float kStraight = 0.02;
const float kSamePlane = 2e-3; // most difference of inverse depths, as a part of the pixel's

// Of a tile first one pixel of kStep x kStep, its nodes, and those beside it.
const uint kNodes = kLightBin / kStep + 1; // in a row
shared vec3 node_light[kNodes * kNodes];
shared float node_inverse[kNodes * kNodes]; // 1 / view depth
shared uint has_core; // 1: near_light of some node

// Weights of a cubic through four equally spaced values at 0 ... 3.
vec4 cubicThrough(float t) {
    const float a = t - 1, b = t - 2, c = t - 3;
    return vec4(-a * b * c / 6, t * b * c / 2, -t * a * c / 2, t * a * b / 6);
}

// True if the nodes tell the light of a pixel of the tile: their cubic hardly differs from straight lines, and the
// surfaces that they end on are one plane with the pixel's.
bool isBetweenNodes(uvec2 pixel, float inverse, out vec3 light) {
    const vec2 at = vec2(pixel) / float(kStep);
    const uvec2 cell = min(uvec2(at), uvec2(kNodes - 2)), first = clamp(cell, uvec2(1), uvec2(kNodes - 3)) - 1;
    const vec4 across = cubicThrough(at.x - float(first.x)), down = cubicThrough(at.y - float(first.y));
    const vec2 part = at - vec2(cell);
    vec3 straight = vec3(0), most = vec3(0);
    float depth = 0;
    light = vec3(0);
    for (uint j = 0; j < 4; ++j)
        for (uint i = 0; i < 4; ++i) {
            const uvec2 node = first + uvec2(i, j);
            const vec3 value = node_light[node.y * kNodes + node.x];
            light += across[i] * down[j] * value;
            depth += across[i] * down[j] * node_inverse[node.y * kNodes + node.x];
            const vec2 near = max(1 - abs(vec2(node) - vec2(cell) - part), 0); // of the cell's four
            straight += near.x * near.y * value;
            most = max(most, value);
        }
    return abs(depth - inverse) <= kSamePlane * inverse && all(lessThanEqual(abs(light - straight), kStraight * most));
}

void main() {
    enterView(0);
    const uint lane = gl_LocalInvocationIndex;
    const uvec2 tile = gl_WorkGroupID.xy * kLightBin + uvec2(0, views[0].first);
    const uvec2 end = uvec2(eye.size.x, views[0].end);
    const bool coarse = kStep > 1 && all(lessThan(tile + kLightBin, end)); // True: all nodes are in the picture
    if (lane == 0) has_core = 0;
    barrier();
    [[dont_unroll]] for (uint part = 0; part < 5; ++part) { // the nodes, then all pixels, 8x8 at a time
        const bool nodes = part == 0;
        const uvec2 quarter = uvec2((part - 1) & 1, (part - 1) >> 1);
        const uvec2 in_tile = nodes ? kStep * uvec2(lane % kNodes, lane / kNodes) :
                                      8 * quarter + gl_LocalInvocationID.xy;
        const uvec2 pixel = tile + in_tile;
        if (nodes ? coarse && lane < kNodes * kNodes : all(lessThan(pixel, end))) {
            const float depth = texelFetch(view_depth, ivec2(pixel), 0).r;
            vec3 light;
            bool near_light = false;
            if (nodes || !coarse || has_core != 0 || !isBetweenNodes(in_tile, 1 / depth, light))
                light = ofPixel(pixel, depth, near_light);
            if (nodes) {
                node_light[lane] = light;
                node_inverse[lane] = 1 / depth;
                if (near_light) atomicOr(has_core, 1);
            } else {
                lit[pixel.y * eye.size.x + pixel.x] = max(light, 0);
            }
        }
        if (nodes) barrier();
    }
}
