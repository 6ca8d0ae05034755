#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Six fluxes, after the last pass: what the cells of a block emit and scatter, as one lamp. A workgroup is a block of
// the finest grid.
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Cells { float cells[]; };
// Net flux and fluence, [channel][z][y][x]: all of it, and that of light which comes straight from surfaces.
layout(scalar) readonly buffer Fluence { vec4 fluence[]; };
layout(scalar) readonly buffer Direct { vec4 direct[]; };

#include "shaders/lib/flux_grid.glsl"
#include "shaders/lib/flux_lamps.glsl"
layout(scalar) writeonly buffer Lamps { FluxLamp lamps[]; };

shared vec3 powers[64];
shared vec4 moments[64]; // power times place and times its squared length
shared vec3 ups[64], downs[64]; // power times the parts that get out

// Power of a cell per volume, W/m^3, in a channel.
float powerOf(uint c, uvec3 place) {
    const uint cell = cellAt(place, push.side), numbers = numbersAt(cell);
    const float extinction = cells[numbers];
    if (!(extinction > 0)) return 0;
    const vec2 scaled = scaledMedium(c, kCellMatter ? cells[scatteringAt(c, cell)] / extinction : 0);
    const uint at = c * push.side * push.side * push.side + cell;
    // What is scattered first of surfaces' light is among the cell's numbers.
    const float there = fluence[at].w - (push.parts > 0 ? direct[at].w : 0);
    return scaled.x * (extinction * scaled.y * there + cells[numbers + 1 + 2 * c]);
}

// The part of a cell's light that gets out of the medium along an axis, unscattered.
float partOut(uvec3 place, uint axis, bool up) {
    const float size = cellSize()[axis], own = size * cells[numbersAt(cellAt(place, push.side))];
    float depth = 0;
    [[dont_unroll]] while (up ? place[axis] + 1 < push.side : place[axis] > 0) {
        place[axis] += up ? 1 : -1;
        depth += cells[numbersAt(cellAt(place, push.side))];
    }
    return phi(own) * exp(-depth * size);
}

void main() {
    const uint lane = gl_LocalInvocationIndex, blocks = kLampBlocks, wide = push.side / blocks;
    const uvec3 block = uvec3(gl_WorkGroupID.x % blocks, gl_WorkGroupID.x / blocks % blocks,
                              gl_WorkGroupID.x / (blocks * blocks));
    const vec3 size = cellSize();
    vec3 power = vec3(0);
    vec4 moment = vec4(0);
    vec3 up = vec3(0), down = vec3(0);
    [[dont_unroll]] for (uint i = lane; i < wide * wide * wide; i += 64) {
        const uvec3 place = block * wide + uvec3(i % wide, i / wide % wide, i / (wide * wide));
        vec3 own = vec3(0);
        for (uint c = 0; c < push.channels; ++c) own[c] = powerOf(c, place);
        const vec3 at = (vec3(place) + 0.5 - 0.5 * float(push.side)) * size;
        const float all = own.x + own.y + own.z;
        power += own;
        if (!(all > 0)) continue;
        moment += all * vec4(at, dot(at, at));
        for (uint axis = 0; axis < 3; ++axis)
            up[axis] += all * partOut(place, axis, true), down[axis] += all * partOut(place, axis, false);
    }
    powers[lane] = power;
    moments[lane] = moment;
    ups[lane] = up;
    downs[lane] = down;
    for (uint step = 32; step > 0; step /= 2) {
        memoryBarrierShared();
        barrier();
        if (lane < step) {
            powers[lane] += powers[lane + step];
            moments[lane] += moments[lane + step];
            ups[lane] += ups[lane + step];
            downs[lane] += downs[lane + step];
        }
    }
    memoryBarrierShared();
    barrier();
    const float all = powers[0].x + powers[0].y + powers[0].z;
    const vec3 middle = (vec3(block) * float(wide) + 0.5 * float(wide) - 0.5 * float(push.side)) * size;
    const vec3 place = all > 0 ? moments[0].xyz / all : middle;
    if (lane < 6) lamps[gl_WorkGroupID.x].through[lane] = all > 0 ? (lane < 3 ? ups[0] : downs[0])[lane % 3] / all : 1;
    if (lane > 0) return;
    const float cell = dot(size, size) / 12; // mean squared distance of even light in a cell from its middle
    lamps[gl_WorkGroupID.x].place = place;
    lamps[gl_WorkGroupID.x].square = (all > 0 ? max(moments[0].w / all - dot(place, place), 0) : 0) + cell;
    lamps[gl_WorkGroupID.x].power = powers[0] * (size.x * size.y * size.z);
}
