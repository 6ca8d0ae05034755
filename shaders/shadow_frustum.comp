#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Shadow frusta: which lights reach the middles of coarse froxels past objects. A lane makes four froxels of a row, z
// is the eye.
#include "shaders/shared/constants.h"
#include "shaders/shared/shadow_frustum.h"
#include "shaders/shared/shadow_grid.h"

layout(local_size_x = 64) in;

layout(scalar) uniform GridBlock { ShadowGridBlock shadow_grid; };
layout(scalar) readonly buffer Frusta { ShadowFrustum shadow_frusta[]; };
layout(scalar) writeonly buffer Froxels { uint shadow_froxels[]; };
layout(scalar) buffer Rays { uint rays_traced; };

#include "shaders/lib/objects.glsl"
#include "shaders/lib/object_tree.glsl"
#include "shaders/lib/mesh.glsl"
#include "shaders/lib/occluded.glsl"

void main() {
    const ShadowFrustum frustum = shadow_frusta[gl_WorkGroupID.z];
    const uint words = frustum.columns / 4, word = gl_GlobalInvocationID.x;
    if (word >= words * frustum.rows * frustum.slices) return;
    const uint slice = word / (words * frustum.rows), row = word / words % frustum.rows, column = 4 * (word % words);
    const float depth = frustum.near + frustum.unit * (exp2(frustum.growth * (float(slice) + 0.5)) - 1);
    uint bits = 0, rays = 0;
    [[dont_unroll]] for (uint i = 0; i < 4; ++i) {
        if ((column + i) * frustum.pixels >= frustum.eye.size.x) break;
        const vec2 pixel = (vec2(column + i, row) + 0.5) * float(frustum.pixels);
        const vec3 direction = frustum.eye.ray + pixel.x * frustum.eye.ray_right + pixel.y * frustum.eye.ray_down;
        const vec3 x = frustum.eye.position + depth * direction;
        if (isInSolid(x)) continue;
        rays += shadow_grid.slots;
        [[dont_unroll]] for (uint s = 0; s < shadow_grid.slots; ++s) {
            const ShadowSlot light = shadow_grid.lights[s];
            const vec3 dir = light.local != 0 ? light.to - x : kSunAway * light.to;
            if (!isOccluded(x, dir)) bits |= 1u << (8 * i + s);
        }
    }
    shadow_froxels[frustum.first + word] = bits;
    if (rays > 0) atomicAdd(rays_traced, rays);
}
