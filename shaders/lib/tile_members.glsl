// Lists the particles (members) of a tile, or of a brick of nodes, from the bits of lib/line_bins_write.glsl. A
// workgroup is one subgroup. Include after `readonly buffer Bins { uint bins[]; }`.
//
// Loops have their condition at the end: a CPU driver computes one round more of a loop whose condition comes first.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "shaders/lib/line_pages.glsl"

const uint kLanes = gl_WorkGroupSize.x;

layout(constant_id = kIdLockstep) const bool kLockstep = false;

// What lanes have written to shared memory can be read by all after it. A CPU driver would suspend the workgroup at
// every barrier, for lanes that are one vector.
void meetLanes() {
    if (kLockstep) memoryBarrierShared();
    else subgroupBarrier();
}

uint ballot(bool value) { return subgroupBallot(value).x; }

const uint kNoLine = 0xffffffffu;
// The lines whose common particles are asked for.
struct Lines {
    uint from;               // index of the bits of line 0
    uint column, row, sheet; // numbers of the lines; kNoLine: any
    uint all;                // number of lines that there are
    uint words;              // number of words that a line has
};

uint pagesOf(Lines lines, uint line, uint part) {
    return line == kNoLine ? 0xffffffffu : bins[lines.from + pageWord(line, part, lines.all, lines.words)];
}
uint bitsOf(Lines lines, uint line, uint word) {
    return line == kNoLine ? 0xffffffffu : bins[lines.from + line * lines.words + word];
}

// Bits of the particles of a lane's word that are on all lines: of word `word` in the first lane, and so on. `word` is
// a multiple of kLanes. It is moved on to the next page with members, or behind all words.
uint nextBits(Lines lines, inout uint word) {
    if (word % kPage == 0) {
        const uint page = word / kPage, part = page / 32;
        const uint left = (pagesOf(lines, lines.column, part) & pagesOf(lines, lines.row, part) &
                           pagesOf(lines, lines.sheet, part)) >> (page % 32);
        word = left == 0 ? (part + 1) * 32 * kPage : word + findLSB(left) * kPage;
    }
    const uint mine = word + gl_SubgroupInvocationID;
    if (mine >= lines.words) return 0;
    return bitsOf(lines, lines.column, mine) & bitsOf(lines, lines.row, mine) & bitsOf(lines, lines.sheet, mine);
}
