// Adds particles (members) to the 8x8 points of a tile on a lane's plane. These points are equally spaced. A Gaussian
// is then a product of two recurrences, and adding a particle to 64 points costs little more than 64 multiply-adds.
// The recurrences begin in the middle of the tile. A workgroup is one subgroup.
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require

const uint kPoints = kSlabTile * kSlabTile, kMiddle = kSlabTile / 2;

// A member as a lane holds it: SlabMember with one extinction.
struct Held {
    vec3 centre;
    float across, along, sigma;
};
const Held kNoMember = Held(vec3(0), 0, 0, 0);

Held heldMember(SlabMember m, uint quantity) {
    const float part = quantity >= kScattering ? m.albedo[quantity - kScattering] : 1;
    return Held(m.centre, m.across, m.along, m.sigma * part);
}

// The member that lane `j` of the subgroup holds.
Held ofLane(Held mine, uint j) {
    return Held(vec3(subgroupShuffle(mine.centre.x, j), subgroupShuffle(mine.centre.y, j),
                     subgroupShuffle(mine.centre.z, j)),
                subgroupShuffle(mine.across, j), subgroupShuffle(mine.along, j), subgroupShuffle(mine.sigma, j));
}

// Values along one axis: of the middle point, factors to the next and to the one before it, and the ratio of one factor
// to the last.
struct Steps {
    float middle, next, last, ratio;
};

// Steps of exp2(-across (d + i spacing)^2) exp2(more), i counted from the middle point. `ratio`: exp2(-2 across
// spacing^2). A member may be far from a tile on planes that it does not reach. Its values are 0 there, and factors
// that are infinite would make them NaN.
Steps stepsOf(float across, float d, float spacing, float ratio, float more) {
    const float next = exp2(clamp(-across * spacing * (2 * d + spacing), -100, 100));
    return Steps(exp2(more - across * d * d), next, ratio / next, ratio);
}

struct Splat {
    float columns[kSlabTile]; // values of the middle row, times the extinction
    Steps rows;               // factors of the others
};

// exp(-k^2 |d|^2) of a member on the lane's plane. `at`: the tile's first point there, in the units of
// SlabMember::centre.
Splat splat(Held m, vec3 at, float spacing) {
    const vec3 d = at + vec3(vec2(float(kMiddle) * spacing), 0) - m.centre;
    const float ratio = exp2(-2 * m.across * spacing * spacing);
    Splat s;
    s.rows = stepsOf(m.across, d.y, spacing, ratio, 0);
    Steps x = stepsOf(m.across, d.x, spacing, ratio, -m.along * d.z * d.z);
    float up = m.sigma * x.middle, down = up;
    s.columns[kMiddle] = up;
    [[unroll]] for (uint i = 1; i < kMiddle; ++i) {
        up *= x.next, x.next *= ratio;
        s.columns[kMiddle + i] = up;
    }
    [[unroll]] for (uint i = 1; i <= kMiddle; ++i) {
        down *= x.last, x.last *= ratio;
        s.columns[kMiddle - i] = down;
    }
    return s;
}

void addRow(inout float sum[kPoints], uint y, float one, Splat a, float two, Splat b) {
    [[unroll]] for (uint x = 0; x < kSlabTile; ++x) sum[y * kSlabTile + x] += one * a.columns[x] + two * b.columns[x];
}

// Adds the first `end` members of the subgroup to the points, two at a time, and at least the first two. They are not
// small (kSmallMember).
void addMembers(inout float sum[kPoints], Held mine, uint end, vec3 at, float spacing) {
    uint j = 0;
    do {
        const Splat a = splat(ofLane(mine, j), at, spacing),
                    b = splat(kLanes > 1 ? ofLane(mine, j + 1) : kNoMember, at, spacing);
        Steps one = a.rows, two = b.rows;
        float up_one = one.middle, up_two = two.middle, down_one = up_one, down_two = up_two;
        addRow(sum, kMiddle, up_one, a, up_two, b);
        [[unroll]] for (uint i = 1; i < kMiddle; ++i) {
            up_one *= one.next, one.next *= one.ratio;
            up_two *= two.next, two.next *= two.ratio;
            addRow(sum, kMiddle + i, up_one, a, up_two, b);
        }
        [[unroll]] for (uint i = 1; i <= kMiddle; ++i) {
            down_one *= one.last, one.last *= one.ratio;
            down_two *= two.last, two.last *= two.ratio;
            addRow(sum, kMiddle - i, down_one, a, down_two, b);
        }
        j += 2;
    } while (j < end);
}

// Adds a member without recurrences.
void addSmall(inout float sum[kPoints], Held m, vec3 at, float spacing) {
    const vec3 d = at - m.centre;
    const float here = m.sigma * exp2(-m.along * d.z * d.z);
    float columns[kSlabTile];
    [[unroll]] for (uint x = 0; x < kSlabTile; ++x) {
        const float dx = d.x + float(x) * spacing;
        columns[x] = here * exp2(-m.across * dx * dx);
    }
    [[unroll]] for (uint y = 0; y < kSlabTile; ++y) {
        const float dy = d.y + float(y) * spacing, row = exp2(-m.across * dy * dy);
        [[unroll]] for (uint x = 0; x < kSlabTile; ++x) sum[y * kSlabTile + x] += row * columns[x];
    }
}
