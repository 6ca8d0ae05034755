#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `lit`, once a tick for all viewers: the light that arrives at each node of the shared grid, past objects and
// through the medium. A workgroup is a brick, a lane a column of nodes.
#include "shaders/shared/constants.h"
#include "shaders/shared/lit_grid.h"

layout(local_size_x = 8, local_size_y = 8) in; // kSlabTile

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;

#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer LitNodes { float lit_nodes[]; };
layout(scalar) writeonly buffer SunNodes { float sun_nodes[]; };
layout(scalar) readonly buffer Marks { uint marks[]; }; // lib/grid_marks.glsl

layout(push_constant, scalar) uniform Push {
    LitGridShape lit;
    MediumGrid medium;
} push;

Eye eye; // what is included names it; nothing here reads it

#include "shaders/lib/grid_marks.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"
#include "shaders/lib/occluded.glsl"
#include "shaders/lib/near_lights.glsl"
#include "shaders/lib/sun_at_node.glsl"
#include "shaders/lib/spread.glsl"

// The part of a light that arrives at x, past objects and through the medium.
float arrivingPart(LocalLight light, vec3 x, vec3 away, float distance) {
    if (light.shadows != 0 && kHasOpaque && isOccluded(x, -away, true)) return 0;
    return exp(-(kHasFog ? fogFrom(light, away, distance) : 0) - particlesFromBeside(light, away, distance));
}

// True if a place within two spacings of x may have light of it: interpolation reads that far.
bool shinesAround(LocalLight light, vec3 away, float distance) {
    const vec3 bright = max(light.cos_outer > -1 ? dot(away, light.axis) : 0, 0) * light.axis;
    const float off = length(away - bright);
    const vec3 there = bright + (away - bright) * (max(off - 2 * push.lit.spacing, 0) / max(off, 1e-20));
    return sentTo(light, there, length(there)) > 0 || distance <= 4 * push.lit.spacing;
}

// Writes the part of each light that arrives.
void keepLights(vec3 x, uint at) {
    [[dont_unroll]] for (uint i = 0; i < push.lit.numbers; ++i) {
        const LocalLight light = local_lights[i];
        const vec3 away = x - light.position;
        const float distance = length(away);
        const bool shines = shinesAround(light, away, distance);
        lit_nodes[push.lit.numbers * at + i] = shines ? arrivingPart(light, x, away, distance) : 0;
    }
}

// Writes the fluence of all lights, and unit directions times it.
void keepFluence(vec3 x, uint at) {
    vec3 fluence = vec3(0);
    mat3 ways = mat3(0); // columns: red, green, blue
    [[dont_unroll]] for (uint i = 0; i < tick.local_light_count; ++i) {
        const LocalLight light = local_lights[i];
        const vec3 away = x - light.position;
        const float distance = length(away), kept = keptPart(distance);
        const float sent = kept > 0 ? sentTo(light, away, distance) : 0;
        if (!(sent > 0)) continue;
        const float falls = 1 / (distance * distance + light.radius * light.radius);
        const vec3 arrives = light.intensity * (kept * sent * falls * arrivingPart(light, x, away, distance));
        fluence += arrives;
        ways += outerProduct(away / distance, arrives);
    }
    [[unroll]] for (uint c = 0; c < 3; ++c) {
        [[unroll]] for (uint i = 0; i < 3; ++i) lit_nodes[push.lit.numbers * at + 4 * c + i] = ways[c][i];
        lit_nodes[push.lit.numbers * at + 4 * c + 3] = fluence[c];
    }
}

void main() {
    const uvec3 brick = spreadGroup();
    const bool known =
        push.lit.particles == 0 || (marks[markWord(kRead, brick)] >> (brick.x % 32) & 1) != 0;
    if (!known) return; // nothing reads it
    const uvec3 size = push.lit.bricks * kSlabTile;
    [[dont_unroll]] for (uint z = 0; z < kSlabTile; ++z) {
        const uvec3 node = brick * kSlabTile + uvec3(gl_LocalInvocationID.xy, z);
        const vec3 x = push.lit.origin + push.lit.spacing * vec3(node);
        const uint at = (node.z * size.y + node.y) * size.x + node.x;
        sun_nodes[at] = tick.sun.irradiance != vec3(0) ? sunAt(x) : 0;
        if (!kHasLocalLights) continue;
        if (push.lit.keeps == kKeepsLights) keepLights(x, at);
        else keepFluence(x, at);
    }
}
