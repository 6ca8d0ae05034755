#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Six fluxes, first pass: extinction and first scattering of the finest cells, from the sun's volumetric shadow map,
// and what they emit. A lane is a cell.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

layout(constant_id = kIdHasCasters) const bool kHasCasters = true;

#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer Cells { float cells[]; };
struct CellMatter {
    vec3 albedo, emission; // emission: radiance per optical depth
};
layout(scalar) readonly buffer Matter { CellMatter matter[]; }; // [z][y][x]

#include "shaders/lib/flux_grid.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/mesh_heights.glsl"

const float kPi = 3.14159265;
const uint kAcross = 2; // columns of a cell along x and y, whose middles are looked up

void main() {
    if (gl_GlobalInvocationID.x >= push.side * push.side * push.side) return;
    const uvec3 place = placeOf(gl_GlobalInvocationID.x);
    const float planes = float(tick.map.slices - 1), height = cellSize().z;
    float extinction = 0;
    vec3 source = vec3(0);
    vec2 scaled[3]; // scaledMedium() of each channel
    const uint cell = cellAt(place, push.side);
    for (uint c = 0; c < push.channels; ++c) scaled[c] = scaledMedium(c, kCellMatter ? matter[cell].albedo[c] : 0);
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
                         firstScattered(scaled[c].y, tick.multiple.passed[c] * before, scaled[c].x * own);
    }
    const float scale = 1 / (float(kAcross * kAcross) * height);
    const uint to = numbersAt(cell);
    cells[to] = extinction * scale;
    for (uint c = 0; c < push.channels; ++c) {
        const float sun = source[c] * (scale * tick.multiple.sun[c]), own = extinction * scale;
        cells[to + 1 + 2 * c] = cells[to + 2 + 2 * c] = sun;
        if (!kCellMatter) continue;
        // What is emitted goes all ways alike. Sources are of the scaled medium, which has less extinction.
        cells[to + 1 + 2 * c] = sun + 4 * kPi * own * matter[cell].emission[c] / max(scaled[c].x, 1e-6);
        cells[scatteringAt(c, cell)] = own * matter[cell].albedo[c];
    }
}
