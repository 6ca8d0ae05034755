// Which columns, rows and sheets of tiles each particle reaches: one bit for a particle and a line of tiles, no lists, no order to keep.
// A workgroup of 32 lanes, one per particle. Include after `buffer Bins { uint bins[]; }`, which holds zeros before.
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "shaders/lib/line_pages.glsl"

// Of the workgroup's 32 particles, this lane's.
uint laneOfWord() { return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID; }

// Tiles from `lo` to `hi`, of `count`.
ivec2 span(float lo, float hi, uint count) {
    return ivec2(clamp(vec2(floor(lo), floor(hi)), vec2(0, -1), vec2(float(count), float(count) - 1)));
}

// Sets bins[line][32 particles], and pages, from bins[from] on. `reach`: first and last column, row and sheet of this lane's particle, the first after the
// last where it reaches none; `lines`: how many there are. Called by all lanes. Neighbours in space that are neighbours in memory, too,
// leave most lines alone.
void writeBins(uint from, ivec2 reach[3], uvec3 lines) {
    const uint all = lines.x + lines.y + lines.z, words = gl_NumWorkGroups.x, word = gl_WorkGroupID.x, page = word / kPage;
    uint first = 0; // line of the axis
    for (uint axis = 0; axis < 3; ++axis) {
        const bool some = reach[axis].x <= reach[axis].y;
        ivec2 ends = some ? reach[axis] : ivec2(1 << 30, -1);
        for (uint step = 1; step < min(gl_SubgroupSize, 32); step *= 2)
            ends = ivec2(min(ends.x, subgroupShuffleXor(ends.x, step)), max(ends.y, subgroupShuffleXor(ends.y, step)));
        for (int at = ends.x; at <= ends.y; ++at) {
            const uint bits = subgroupBallot(some && at >= reach[axis].x && at <= reach[axis].y).x;
            const uint line = first + uint(at);
            if (!subgroupElect()) continue;
            atomicOr(bins[from + line * words + word], bits << (gl_SubgroupID * gl_SubgroupSize));
            atomicOr(bins[from + pageWord(line, page / 32, all, words)], 1u << (page % 32));
        }
        first += lines[axis];
    }
}
