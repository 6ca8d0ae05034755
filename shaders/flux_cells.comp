#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Six fluxes, first pass: extinction and first scattering of the finest cells, from the sun's volumetric shadow map. A
// lane is a cell.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

layout(constant_id = kIdHasCasters) const bool kHasCasters = true;

#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer Cells { float cells[]; };

#include "shaders/lib/flux_grid.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/mesh_heights.glsl"

const uint kAcross = 2; // columns of a cell along x and y, whose middles are looked up

void main() {
    if (gl_GlobalInvocationID.x >= push.side * push.side * push.side) return;
    const uvec3 place = placeOf(gl_GlobalInvocationID.x);
    const float planes = float(tick.map.slices - 1), height = cellSize().z;
    float extinction = 0;
    vec3 source = vec3(0);
    for (uint i = 0; i < kAcross * kAcross; ++i) {
        const vec2 at = (vec2(place.xy) + (vec2(i % kAcross, i / kAcross) + 0.5) / float(kAcross)) / float(push.side);
        const vec2 ends = vec2(place.z, place.z + 1) / float(push.side);
        const float before = lightDepth(vec3(at, ends.x * planes));
        const float own = max(lightDepth(vec3(at, ends.y * planes)) - before, 0);
        const vec3 middle = mix(tick.map.lo, tick.map.hi, vec3(at, 1 - 0.5 * (ends.x + ends.y)));
        float lit = kHasCasters ? visibility(middle) : 1;
        if (kHasMeshes) lit *= visibilityPastMeshes(middle);
        if (kHasFog) lit *= exp(-fogTowardSun(fromLightSpace(middle)));
        extinction += own;
        for (uint c = 0; c < push.channels; ++c)
            source[c] += own * lit *
                         firstScattered(tick.multiple.albedo[c], tick.multiple.passed[c] * before,
                                        tick.multiple.passed[c] * own);
    }
    const float scale = 1 / (float(kAcross * kAcross) * height);
    const uint to = numbersAt(cellAt(place, push.side));
    cells[to] = extinction * scale;
    for (uint c = 0; c < push.channels; ++c)
        cells[to + 1 + 2 * c] = cells[to + 2 + 2 * c] = source[c] * (scale * tick.multiple.sun[c]);
}
