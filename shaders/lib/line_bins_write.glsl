// Which columns, rows and sheets of tiles each of 32 particles reaches: one bit for a particle and a line of tiles, no lists, no order
// to keep. A workgroup of 32 lanes, one per particle. Include after `writeonly buffer Bins { uint bins[]; }`.

shared ivec2 reach[3][32]; // first and last column, row, sheet

// Tiles from `lo` to `hi`, of `count`.
ivec2 span(float lo, float hi, uint count) {
    return ivec2(clamp(vec2(floor(lo), floor(hi)), vec2(0, -1), vec2(float(count), float(count) - 1)));
}

// Writes bins[line][32 particles] after every lane has set its `reach`; lines: how many columns, rows, sheets.
void writeBins(uvec3 lines) {
    barrier();
    const uvec3 end = uvec3(lines.x, lines.x + lines.y, lines.x + lines.y + lines.z);
    for (uint line = gl_LocalInvocationIndex; line < end.z; line += 32) {
        const uint axis = uint(line >= end.x) + uint(line >= end.y);
        const int at = int(line - (axis == 0 ? 0 : axis == 1 ? end.x : end.y));
        uint bits = 0;
        for (uint j = 0; j < 32; ++j) bits |= uint(at >= reach[axis][j].x && at <= reach[axis][j].y) << j;
        bins[line * gl_NumWorkGroups.x + gl_WorkGroupID.x] = bits;
    }
}
