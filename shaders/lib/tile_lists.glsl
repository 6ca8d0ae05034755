// Lists of a tile's particles (members), and of those in each of its sheets: slabs or planes that are filled together.
// A workgroup lists the members of its tile once, then chooses those of one sheet after the other.
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/tile_members.glsl"

const uint kWordMembers = 32; // members of a word of bits

shared uint listed[kMostListed];                                  // members, packed; some from the end on
shared uint chosen[kMostListed];                                  // indices of one sheet's members
shared uint in_sheet[kMostListed / kWordMembers * kMostTogether]; // [word][sheet]: bits of the members that are in it

// True if the list takes what another round may find: a particle for each bit of the lanes' words.
bool hasRoom(uint count) { return count + 32 * kLanes <= kMostListed; }

const uint kIndexBits = 21, kSheetBits = 5;

// A member's index, its first and its last sheet.
uint packed(uint index, uvec2 sheets) {
    return index | sheets.x << kIndexBits | sheets.y << (kIndexBits + kSheetBits);
}
const uint kNoneListed = 1u << kIndexBits; // its first sheet lies behind its last
uint indexOf(uint one) { return one & ((1u << kIndexBits) - 1); }
bool isIn(uint one, uint sheet) {
    return (one >> kIndexBits & (kMostTogether - 1)) <= sheet && sheet <= one >> (kIndexBits + kSheetBits);
}
// Bits of the sheets between two of them.
uint sheetBits(uvec2 sheets) { return (2u << sheets.y) - (1u << sheets.x); }

// Writes `in_sheet` for the first `count` members of the list. A lane is a sheet.
void sortIntoSheets(uint count, uint sheets) {
    uint round = 0; // every lane takes part in all rounds
    do {
        const uint sheet = round + gl_SubgroupInvocationID;
        uint first = 0;
        do {
            uint bits = 0;
            [[unroll]] for (uint i = 0; i < kWordMembers; i += kLanes) {
                const uint mine = first + i + gl_SubgroupInvocationID;
                const uint one = mine < count ? listed[mine] : kNoneListed;
                [[unroll]] for (uint k = 0; k < kLanes; ++k)
                    bits |= isIn(subgroupBroadcast(one, k), sheet) ? 1u << (i + k) : 0;
            }
            in_sheet[first / kWordMembers * kMostTogether + sheet] = bits;
            first += kWordMembers;
        } while (first < count);
        round += kLanes;
    } while (round < sheets);
}

// Writes the indices of a sheet's members to `chosen`, of the first `count` in the list. Returns how many there are.
uint chooseMembers(uint count, uint sheet) {
    const uint kOfLane = kWordMembers / kLanes;
    uint first = 0, some = 0;
    do {
        const uint bits = in_sheet[first / kWordMembers * kMostTogether + sheet];
        if (bits != 0) {
            [[unroll]] for (uint i = 0; i < kOfLane; ++i) {
                const uint bit = gl_SubgroupInvocationID * kOfLane + i;
                const uint index = indexOf(listed[first + bit]);
                if ((bits >> bit & 1) != 0) chosen[some + bitCount(bits & ((1u << bit) - 1))] = index;
            }
        }
        some += bitCount(bits);
        first += kWordMembers;
    } while (first < count);
    return some;
}
