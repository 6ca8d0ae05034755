#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Six fluxes: a cell of a grid is the mean of eight cells of the next finer one, which lie before it. A lane is a cell.
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

layout(scalar) buffer Cells { float cells[]; };

#include "shaders/lib/flux_grid.glsl"

void main() {
    if (gl_GlobalInvocationID.x >= push.side * push.side * push.side) return;
    const uvec3 place = placeOf(gl_GlobalInvocationID.x);
    const uint finer = push.side * 2, first = push.first - finer * finer * finer;
    for (uint q = 0; q < numbersOfCell(); ++q) {
        float sum = 0;
        for (uint i = 0; i < 8; ++i)
            sum += cells[numbersAt(first + cellAt(2 * place + uvec3(i & 1, i >> 1 & 1, i >> 2), finer)) + q];
        cells[numbersAt(push.first + cellAt(place, push.side)) + q] = sum / 8;
    }
}
