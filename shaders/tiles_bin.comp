#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_shuffle : require
// Method `tiles`, second pass, per eye: bit masks of the splats that each block of tiles may see, near to far. A lane
// is a block.
#include "shaders/shared/types.h"
#include "shaders/shared/splat.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/eye.glsl"
layout(scalar) readonly buffer Arguments { DrawArguments arguments; };
layout(scalar) readonly buffer Cones { SplatCone cones[]; };
layout(scalar) writeonly buffer Masks { uint masks[]; }; // [word][block]

layout(push_constant, scalar) uniform Push { SplatGrid grid; } push;

#include "shaders/lib/eye.glsl"
#include "shaders/lib/tiles.glsl"

void main() {
    const uint word = gl_WorkGroupID.y, block = gl_GlobalInvocationID.x, visible = arguments.instance_count;
    if (word * 32 >= visible) return;
    const uvec2 at = uvec2(block % push.grid.blocks.x, block / push.grid.blocks.x) * push.grid.block;
    const PixelCone cone = pixelCone(at, at + push.grid.block);
    // Each lane loads a splat, then all lanes test it against their blocks.
    const uint size = min(gl_SubgroupSize, 32); // divides the workgroup, or is larger
    uint mask = 0;
    for (uint bit = 0; bit < 32; bit += size) {
        const uint mine = word * 32 + bit + gl_SubgroupInvocationID;
        SplatCone loaded = SplatCone(vec3(0), -4); // a cone that meets nothing
        if (gl_SubgroupInvocationID < size && mine < visible) loaded = cones[mine];
        for (uint j = 0; j < size; ++j) {
            const vec3 direction = vec3(subgroupShuffle(loaded.direction.x, j), subgroupShuffle(loaded.direction.y, j),
                                        subgroupShuffle(loaded.direction.z, j));
            const float reach = subgroupShuffle(loaded.chord, j) + cone.chord;
            const vec3 apart = direction - cone.direction;
            mask |= reach > 0 && dot(apart, apart) <= reach * reach ? 1u << (bit + j) : 0;
        }
    }
    if (block < push.grid.blocks.x * push.grid.blocks.y)
        masks[word * push.grid.blocks.x * push.grid.blocks.y + block] = mask;
}
