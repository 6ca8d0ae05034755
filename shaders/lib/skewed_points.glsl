// Adds ellipsoids (members with a Skew) to the 8x8 points of a tile on a lane's plane. Along a row their values are a
// product of two recurrences, as balls' are; each row begins anew. Include after lib/tile_points.glsl.
#include "shaders/shared/types.h"

struct HeldSkewed {
    Held member;
    Skew skew;
};
const HeldSkewed kNoneSkewed = HeldSkewed(kNoMember, Skew(0, 0, 0, vec2(0)));

HeldSkewed ofLane(HeldSkewed mine, uint j) {
    return HeldSkewed(ofLane(mine.member, j),
                      Skew(subgroupShuffle(mine.skew.xx, j), subgroupShuffle(mine.skew.xy, j),
                           subgroupShuffle(mine.skew.yy, j),
                           vec2(subgroupShuffle(mine.skew.tilt.x, j), subgroupShuffle(mine.skew.tilt.y, j))));
}

// -log2 of the member's part of its peak, at a place from its centre.
float fallOff(HeldSkewed h, vec3 d) {
    const float z = d.z - dot(h.skew.tilt, d.xy);
    return h.skew.xx * d.x * d.x + 2 * h.skew.xy * d.x * d.y + h.skew.yy * d.y * d.y + h.member.along * z * z;
}

// Adds one member. `at`: the tile's first point, in the units of SlabMember::centre.
void addSkewed(inout float sum[kPoints], HeldSkewed h, vec3 at, float spacing) {
    const vec3 first = at + vec3(float(kMiddle) * spacing, 0, 0) - h.member.centre;
    const float bend = h.skew.xx + h.member.along * h.skew.tilt.x * h.skew.tilt.x;
    const float ratio = exp2(-2 * bend * spacing * spacing);
    [[unroll]] for (uint y = 0; y < kSlabTile; ++y) {
        const vec3 d = first + vec3(0, float(y) * spacing, 0);
        // What the fall-off grows by to the next point, less the bend's part of it.
        const float slope = 2 * (h.skew.xx * d.x + h.skew.xy * d.y -
                                 h.member.along * h.skew.tilt.x * (d.z - dot(h.skew.tilt, d.xy)));
        float next = exp2(clamp(-spacing * (slope + bend * spacing), -100, 100)), last = ratio / next;
        float up = h.member.sigma * exp2(-fallOff(h, d)), down = up;
        sum[y * kSlabTile + kMiddle] += up;
        [[unroll]] for (uint i = 1; i < kMiddle; ++i) {
            up *= next, next *= ratio;
            sum[y * kSlabTile + kMiddle + i] += up;
        }
        [[unroll]] for (uint i = 1; i <= kMiddle; ++i) {
            down *= last, last *= ratio;
            sum[y * kSlabTile + kMiddle - i] += down;
        }
    }
}

// Adds the first `end` members of the subgroup to the points.
void addAllSkewed(inout float sum[kPoints], HeldSkewed mine, uint end, vec3 at, float spacing) {
    uint j = 0;
    do {
        addSkewed(sum, ofLane(mine, j), at, spacing);
    } while (++j < end);
}

// Adds a member without recurrences.
void addSmallSkewed(inout float sum[kPoints], HeldSkewed h, vec3 at, float spacing) {
    [[unroll]] for (uint y = 0; y < kSlabTile; ++y)
        [[unroll]] for (uint x = 0; x < kSlabTile; ++x)
            sum[y * kSlabTile + x] +=
                h.member.sigma *
                exp2(-fallOff(h, at + vec3(float(x) * spacing, float(y) * spacing, 0) - h.member.centre));
}
