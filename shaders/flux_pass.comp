#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Six fluxes: half steps on one grid. In each, every second cell takes what its neighbours, which are of the other
// half, let out. A lane is a cell after another. More than one half step is made by one workgroup alone.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"

layout(local_size_x = 256) in;

layout(constant_id = kIdOwnLight) const bool kOwnLight = false;

#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Cells { float cells[]; };
layout(scalar) coherent buffer FluxesBlock { float fluxes[]; };
// Net flux and fluence, [channel][z][y][x]; before, those of light from surfaces.
layout(scalar) buffer Fluence { vec4 fluence[]; };

#include "shaders/lib/flux_grid.glsl"

// What comes from outside up or down an axis.
float fromOutside(uint channel, uint axis, bool up) {
    if (!kOwnLight) return 0;
    const float more = tick.multiple.entering_up[axis][channel];
    return tick.multiple.entering[channel] + (up ? more : -more);
}

// What leaves the cell before this one along an axis (0 ... 2 up it, 3 ... 5 down it), or comes from outside.
float from(uint channel, uvec3 place, uint way) {
    const uint axis = way % 3;
    const bool up = way < 3;
    if (up ? place[axis] == 0 : place[axis] + 1 == push.side) return fromOutside(channel, axis, up);
    place[axis] += up ? -1 : 1;
    return fluxes[fluxesAt(channel, push.first + cellAt(place, push.side)) + way];
}

// The cell of index `at` in the half of this parity.
void passFluxes(uint at, uint parity) {
    const uint half_side = push.side / 2;
    uvec3 place = uvec3(at % half_side, at / half_side % push.side, at / (half_side * push.side));
    place.x = 2 * place.x + ((place.y + place.z + parity) & 1);
    const uint cell = push.first + cellAt(place, push.side), numbers = numbersAt(cell);
    const float extinction = cells[numbers];
    for (uint c = 0; c < push.channels; ++c) {
        Fluxes entering;
        for (uint axis = 0; axis < 3; ++axis) {
            entering.up[axis] = from(c, place, axis);
            entering.down[axis] = from(c, place, axis + 3);
        }
        const float all = cells[numbers + 1 + 2 * c], sunward = all > 0 ? cells[numbers + 2 + 2 * c] / all : 0;
        const float source = extinction > 0 ? all / extinction : 0;
        const float albedo = kCellMatter && extinction > 0 ? cells[scatteringAt(c, cell)] / extinction : 0;
        const vec2 scaled = scaledMedium(c, albedo);
        const FluxCell passed = passCell(entering, extinction * scaled.x * cellSize(), scaled.y,
                                         tick.multiple.asymmetry, source, vec3(0, 0, sunward));
        const uint to = fluxesAt(c, cell);
        for (uint axis = 0; axis < 3; ++axis) {
            fluxes[to + axis] = passed.leaving.up[axis];
            fluxes[to + 3 + axis] = passed.leaving.down[axis];
        }
        if (push.last == 1) {
            const uint texel = (c * push.side + place.z) * push.side * push.side + place.y * push.side + place.x;
            const vec4 there = vec4(passed.flux, passed.fluence);
            fluence[texel] = push.parts > 0 ? fluence[texel] + there : there;
        }
    }
}

void main() {
    const uint cells_of_half = push.side * push.side * push.side / 2;
    for (uint i = 0; i < push.half_steps; ++i) {
        for (uint at = gl_GlobalInvocationID.x; at < cells_of_half; at += gl_NumWorkGroups.x * gl_WorkGroupSize.x)
            passFluxes(at, (push.parity + i) & 1);
        memoryBarrierBuffer();
        barrier();
    }
}
