#extension GL_KHR_shader_subgroup_shuffle : require
// Values of some pixels of a tile, its nodes, and those between them. Include after these are declared: kStep, the
// distance of nodes in pixels; kStraight, the most that their cubic differs from straight lines, as a part of the
// largest value.

const float kSamePlane = 2e-3; // most difference of inverse depths, as a part of the pixel's

// Of a tile one pixel of kStep x kStep, and those beside it.
const uint kNodes = kPixelTile / kStep + 1; // in a row
shared vec3 node_value[kNodes * kNodes];
shared float node_inverse[kNodes * kNodes]; // 1 / view depth

// Weights of a cubic through four equally spaced values at 0 ... 3.
vec4 cubicThrough(float t) {
    const float a = t - 1, b = t - 2, c = t - 3;
    return vec4(-a * b * c / 6, t * b * c / 2, -t * a * c / 2, t * a * b / 6);
}

// A column of nodes at the height of a row of pixels.
struct NodeColumn {
    vec3 value, straight; // by the cubic down the column, and by a straight line
    vec3 most;            // largest value of the cubic's nodes
    float inverse;        // by the cubic
};

// `at`: the row, in nodes.
NodeColumn nodeColumn(uint column, float at) {
    const uint cell = min(uint(at), kNodes - 2), first = clamp(cell, 1, kNodes - 3) - 1;
    const vec4 down = cubicThrough(at - float(first));
    NodeColumn sum = NodeColumn(vec3(0), vec3(0), vec3(0), 0);
    [[unroll]] for (uint j = 0; j < 4; ++j) {
        const uint node = (first + j) * kNodes + column;
        const vec3 there = node_value[node];
        sum.value += down[j] * there;
        sum.straight += max(1 - abs(float(first + j) - at), 0) * there; // weights: 0 but for the cell's two nodes
        sum.most = max(sum.most, there);
        sum.inverse += down[j] * node_inverse[node];
    }
    return sum;
}

vec3 ofLane(vec3 own, uint lane) {
    return vec3(subgroupShuffle(own.x, lane), subgroupShuffle(own.y, lane), subgroupShuffle(own.z, lane));
}

// True if the nodes tell the value of a pixel of the tile: their cubic hardly differs from straight lines, neither
// across nor down, and the surfaces that they end on are one plane with the pixel's. Called by all lanes. Eight
// neighbours have eight pixels of a row: each interpolates one column, for all of them.
bool isBetweenNodes(uvec2 pixel, float inverse, out vec3 value) {
    const vec2 at = vec2(pixel) / float(kStep);
    const uint cell = min(uint(at.x), kNodes - 2), first = clamp(cell, 1, kNodes - 3) - 1;
    const vec4 across = cubicThrough(at.x - float(first));
    const uint lane = gl_SubgroupInvocationID;
    const bool together = gl_SubgroupSize >= 8;
    const NodeColumn own = nodeColumn(together ? min(lane % 8, kNodes - 1) : first, at.y);
    vec3 straight_across = vec3(0), straight_down = vec3(0), most = vec3(0);
    float depth = 0;
    value = vec3(0);
    [[unroll]] for (uint i = 0; i < 4; ++i) {
        NodeColumn column;
        if (together) {
            const uint there = lane - lane % 8 + first + i;
            column = NodeColumn(ofLane(own.value, there), ofLane(own.straight, there), ofLane(own.most, there),
                                subgroupShuffle(own.inverse, there));
        } else {
            column = nodeColumn(first + i, at.y);
        }
        value += across[i] * column.value;
        straight_across += max(1 - abs(float(first + i) - at.x), 0) * column.value; // as down a column
        straight_down += across[i] * column.straight;
        most = max(most, column.most);
        depth += across[i] * column.inverse;
    }
    const vec3 bend = max(abs(value - straight_across), abs(value - straight_down));
    return abs(depth - inverse) <= kSamePlane * inverse && all(lessThanEqual(bend, kStraight * most));
}

const float kSameDepth = 0.15; // with soft edges: most difference of inverse depths, as a part of the pixel's
const float kLeastShare = 0.02; // share that a node on the cell's other side still has

// With soft edges: the value between the four nodes around a pixel of the tile, of those whose surfaces lie about where
// its own does. False: there is none.
bool isSmoothed(uvec2 pixel, float inverse, out vec3 value) {
    const uvec2 cell = min(pixel / kStep, uvec2(kNodes - 2));
    const vec2 part = vec2(pixel) / float(kStep) - vec2(cell);
    float shares = 0;
    value = vec3(0);
    [[unroll]] for (uint c = 0; c < 4; ++c) {
        const uvec2 side = uvec2(c & 1, c >> 1);
        const uint node = (cell.y + side.y) * kNodes + cell.x + side.x;
        const vec2 near = mix(1 - part, part, vec2(side)) + kLeastShare;
        const float off = abs(node_inverse[node] - inverse) / (kSameDepth * inverse);
        const float share = near.x * near.y * max(1 - off, 0);
        value += share * node_value[node];
        shares += share;
    }
    value /= max(shares, 1e-20);
    return shares > kLeastShare * kLeastShare;
}
