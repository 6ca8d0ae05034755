// Which columns, rows and sheets of tiles each of 32 particles reaches: one bit for a particle and a line of tiles, no lists, no order
// to keep. A workgroup of 32 lanes, one per particle. Include after `buffer Bins { uint bins[]; }`, which holds zeros before.
#include "shaders/lib/line_pages.glsl"

shared ivec2 reach[3][32]; // first and last column, row, sheet

// Tiles from `lo` to `hi`, of `count`.
ivec2 span(float lo, float hi, uint count) {
    return ivec2(clamp(vec2(floor(lo), floor(hi)), vec2(0, -1), vec2(float(count), float(count) - 1)));
}

// Writes bins[line][32 particles] after every lane has set its `reach`; lines: how many columns, rows, sheets. Neighbours in space that
// are neighbours in memory, too, leave most lines alone.
void writeBins(uvec3 lines) {
    barrier();
    const uint all = lines.x + lines.y + lines.z;
    uint first = 0; // line of the axis
    for (uint axis = 0; axis < 3; ++axis) {
        ivec2 ends = ivec2(1 << 30, -1);
        for (uint j = 0; j < 32; ++j)
            if (reach[axis][j].x <= reach[axis][j].y) ends = ivec2(min(ends.x, reach[axis][j].x), max(ends.y, reach[axis][j].y));
        for (int at = ends.x + int(gl_LocalInvocationIndex); at <= ends.y; at += 32) {
            uint bits = 0;
            for (uint j = 0; j < 32; ++j) bits |= uint(at >= reach[axis][j].x && at <= reach[axis][j].y) << j;
            if (bits == 0) continue;
            const uint line = first + uint(at), page = gl_WorkGroupID.x / kPage;
            bins[line * gl_NumWorkGroups.x + gl_WorkGroupID.x] = bits;
            atomicOr(bins[pageWord(line, page / 32, all, gl_NumWorkGroups.x)], 1u << (page % 32));
        }
        first += lines[axis];
    }
}
