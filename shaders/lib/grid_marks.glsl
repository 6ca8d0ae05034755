// Bit sets of bricks of the medium's grid: bricks whose cells contain medium; bricks whose nodes are read by samples
// in those cells; coarse bricks whose nodes are read by these bricks. Include after `push.medium`.
#include "shaders/lib/coarse_nodes.glsl"

const uint kSampled = 0, kRead = 1, kReadCoarse = 2;

// Word of a brick's bit, brick.x % 32. `set`: kReadCoarse for coarse bricks.
uint markWord(uint set, uvec3 brick) {
    const uvec3 bricks = push.medium.bricks, own = set == kReadCoarse ? coarseBricks() : bricks;
    const uint row = (own.x + 31) / 32, before = (bricks.x + 31) / 32 * bricks.y * bricks.z * set;
    return before + (brick.z * own.y + brick.y) * row + brick.x / 32;
}
