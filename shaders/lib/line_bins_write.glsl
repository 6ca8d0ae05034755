// Marks the columns, rows and sheets of tiles that each particle reaches: one bit per particle and line of tiles. A
// workgroup has 32 lanes, one per particle. Include after `buffer Bins { uint bins[]; }`, which is filled with zeros
// before.
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "shaders/lib/line_pages.glsl"

// Index of this lane's particle.
uint laneOfWord() { return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID; }

// First and last tile between `lo` and `hi`, of `count` tiles.
ivec2 span(float lo, float hi, uint count) {
    return ivec2(clamp(vec2(floor(lo), floor(hi)), vec2(0, -1), vec2(float(count), float(count) - 1)));
}

// Sets bits in bins[line][32 particles] and their pages, from bins[from] on. `reach`: first and last column, row and
// sheet of this lane's particle; first > last if it reaches none. `lines`: number of columns, rows and sheets. Called
// by all lanes. It writes few lines if particles that are neighbours in memory are also neighbours in space.
void writeBins(uint from, ivec2 reach[3], uvec3 lines) {
    const uint all = lines.x + lines.y + lines.z, words = gl_NumWorkGroups.x, word = gl_WorkGroupID.x,
               page = word / kPage;
    uint first = 0; // first line of the axis
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
