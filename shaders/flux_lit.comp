#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Six fluxes: what surfaces send into the cells of the second grid, linearly between them, is scattered first in those
// of the finest. Cells within objects and below the ground do not count. A lane is a cell.
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/tick.glsl"
layout(scalar) buffer Cells { float cells[]; };
layout(scalar) writeonly buffer Fluence { vec4 fluence[]; }; // net flux and fluence, [channel][z][y][x]

#include "shaders/lib/flux_grid.glsl"
layout(scalar) readonly buffer Surfaces { SurfaceLight surfaces[]; }; // [channel][cell]

void main() {
    if (gl_GlobalInvocationID.x >= push.side * push.side * push.side) return;
    const uvec3 place = placeOf(gl_GlobalInvocationID.x);
    const uint coarser = push.side / 2, cell = cellAt(place, push.side), numbers = numbersAt(push.first + cell);
    for (uint c = 0; c < push.channels; ++c) {
        // Where light goes through a medium it falls by the same part from cell to cell: depths are what is linear.
        float parts = 0, sum = 0, depth = 0;
        vec3 way = vec3(0);
        for (uint i = 0; i < 8; ++i) {
            uint at;
            const float part = coarseNeighbour(place, coarser, i, at);
            const SurfaceLight there = surfaces[c * coarser * coarser * coarser + at];
            if (there.fluence < 0) continue;
            parts += part;
            sum += part * there.fluence;
            depth += part * there.fluence * there.depth;
            way += part * there.fluence * there.mean_way;
        }
        vec4 light = vec4(0);
        if (sum > 0) {
            // Mean in the cell, of light that goes all through it.
            const vec3 w = way / max(length(way), 1e-20 * sum), across = abs(w) / cellSize();
            const float own = tick.multiple.passed[c] * cells[numbers] / max(across.x + across.y + across.z, 1e-20);
            light = sum / parts * exp(-max(depth / sum - 0.5 * own, 0)) * phi(own) * vec4(way / sum, 1);
        }
        fluence[c * push.side * push.side * push.side + cell] = light;
        const float own = kCellMatter ? cells[scatteringAt(c, push.first + cell)] / max(cells[numbers], 1e-30) : 0;
        const float source = cells[numbers] * scaledMedium(c, own).y * light.w;
        cells[numbers + 1 + 2 * c] += source;
        if (sum > 0) cells[numbers + 2 + 2 * c] += source * way.z / sum;
    }
}
