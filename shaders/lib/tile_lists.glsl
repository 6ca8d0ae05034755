// Lists of a tile's particles (members), and of those in each of its sheets: slabs or planes that are filled together.
// A workgroup lists the members of its tile once, then chooses those of one sheet after the other. Lists are in the
// order of the particles, so that a sum does not depend on what else there is. Include after this function is declared:
//   uint reachOf(uint particle): the particle's reach, as in SlabMember and LightParticle
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/tile_members.glsl"

const uint kWordMembers = 32; // members of a word of bits

const uint kSmall = 1; // index of what is kept of small members; 0: of the others

shared uint listed[kMostListed]; // members, packed
shared uint chosen[kMostListed]; // indices of one sheet's members
// [small][word][sheet]: bits of the members that are in a sheet
const uint kWords = kMostListed / kWordMembers;
shared uint in_sheet[2 * kWords * kMostTogether];
uint inSheet(uint small, uint word, uint sheet) { return (small * kWords + word) * kMostTogether + sheet; }

// A packed member: its index, its first and its last sheet; the last bit is set for small ones. Scenes have at most a
// million particles, kMostTogether is 2^kSheetBits.
const uint kIndexBits = 21, kSheetBits = 5;

const uint kNoneListed = 1u << kIndexBits; // its first sheet lies behind its last
uint packed(uint index, uvec2 sheets, bool small) {
    return index | sheets.x << kIndexBits | sheets.y << (kIndexBits + kSheetBits) | uint(small) << 31;
}
uint indexOf(uint one) { return one & ((1u << kIndexBits) - 1); }
bool isIn(uint one, uint sheet) {
    return (one >> kIndexBits & (kMostTogether - 1)) <= sheet &&
           sheet <= (one >> (kIndexBits + kSheetBits) & (kMostTogether - 1));
}

// What is in the list.
struct TileList {
    uint count;   // entries, some of none
    uint present; // bits of the sheets that members are in
    bool small;   // True: some are small
};

// Lists the members from word `word` on that are in the sheets sheets.x ... sheets.y - 1, and numbers these from 0.
// Ends when another round may not fit, or `word` is behind all.
TileList listMembers(Lines lines, inout uint word, uvec2 sheets) {
    TileList list = TileList(0, 0, false);
    do {
        uint left = nextBits(lines, word);
        const uint own = bitCount(left), all = subgroupAdd(own);
        if (all > 0) {
            uint to = list.count + subgroupExclusiveAdd(own);
            do {
                if (left != 0) {
                    const uint index = (word + gl_SubgroupInvocationID) * 32 + findLSB(left);
                    left &= left - 1;
                    const uint reach = reachOf(index);
                    const uvec2 reached = uvec2(reach & (kSmallMember - 1), reach >> 16);
                    uint one = kNoneListed;
                    if (reached.x <= reached.y && reached.x < sheets.y && reached.y >= sheets.x) {
                        const uvec2 here = clamp(reached, sheets.x, sheets.y - 1) - sheets.x;
                        list.present |= (2u << here.y) - (1u << here.x);
                        list.small = list.small || (reach & kSmallMember) != 0;
                        one = packed(index, here, (reach & kSmallMember) != 0);
                    }
                    listed[to++] = one;
                }
            } while (ballot(left != 0) != 0);
            list.count += all;
        }
        word += kLanes;
    } while (word < lines.words && list.count + 32 * kLanes <= kMostListed);
    list.present = subgroupOr(list.present);
    list.small = ballot(list.small) != 0;
    return list;
}

// Writes `in_sheet` for the small members or the others. A lane is a sheet.
void sortIntoSheets(TileList list, uint sheets, uint small) {
    uint round = 0; // every lane takes part in all rounds
    do {
        const uint sheet = round + gl_SubgroupInvocationID;
        uint first = 0;
        do {
            uint bits = 0;
            [[unroll]] for (uint i = 0; i < kWordMembers; i += kLanes) {
                if (first + i >= list.count) continue;
                const uint mine = first + i + gl_SubgroupInvocationID;
                uint one = mine < list.count ? listed[mine] : kNoneListed;
                if (one >> 31 != small) one = kNoneListed;
                [[unroll]] for (uint k = 0; k < kLanes; ++k)
                    bits |= isIn(subgroupShuffle(one, k), sheet) ? 1u << (i + k) : 0;
            }
            in_sheet[inSheet(small, first / kWordMembers, sheet)] = bits;
            first += kWordMembers;
        } while (first < list.count);
        round += kLanes;
    } while (round < sheets);
}

// Writes the indices of a sheet's members to `chosen`, the small ones or the others. Returns how many there are.
uint chooseMembers(TileList list, uint sheet, uint small) {
    const uint kOfLane = kWordMembers / kLanes;
    uint first = 0, some = 0;
    do {
        const uint bits = in_sheet[inSheet(small, first / kWordMembers, sheet)];
        if (bits != 0) {
            [[unroll]] for (uint i = 0; i < kOfLane; ++i) {
                const uint bit = gl_SubgroupInvocationID * kOfLane + i;
                const uint index = indexOf(listed[first + bit]);
                if ((bits >> bit & 1) != 0) chosen[some + bitCount(bits & ((1u << bit) - 1))] = index;
            }
        }
        some += bitCount(bits);
        first += kWordMembers;
    } while (first < list.count);
    return some;
}
