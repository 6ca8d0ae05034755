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

// True if the nodes tell the value of a pixel of the tile: their cubic hardly differs from straight lines, neither
// across nor down, and the surfaces that they end on are one plane with the pixel's.
bool isBetweenNodes(uvec2 pixel, float inverse, out vec3 value) {
    const vec2 at = vec2(pixel) / float(kStep);
    const uvec2 cell = min(uvec2(at), uvec2(kNodes - 2)), first = clamp(cell, uvec2(1), uvec2(kNodes - 3)) - 1;
    const vec4 across = cubicThrough(at.x - float(first.x)), down = cubicThrough(at.y - float(first.y));
    const vec2 part = at - vec2(cell);
    vec3 straight_across = vec3(0), straight_down = vec3(0), most = vec3(0);
    float depth = 0;
    value = vec3(0);
    for (uint j = 0; j < 4; ++j)
        for (uint i = 0; i < 4; ++i) {
            const uvec2 node = first + uvec2(i, j);
            const vec3 there = node_value[node.y * kNodes + node.x];
            value += across[i] * down[j] * there;
            depth += across[i] * down[j] * node_inverse[node.y * kNodes + node.x];
            const vec2 near = max(1 - abs(vec2(node) - vec2(cell) - part), 0); // of the cell's four
            straight_across += near.x * down[j] * there;
            straight_down += across[i] * near.y * there;
            most = max(most, there);
        }
    const vec3 bend = max(abs(value - straight_across), abs(value - straight_down));
    return abs(depth - inverse) <= kSamePlane * inverse && all(lessThanEqual(bend, kStraight * most));
}
