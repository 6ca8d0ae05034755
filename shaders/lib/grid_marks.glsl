// Two bit sets of bricks of the medium's grid: bricks whose cells contain medium, and bricks whose nodes are read by
// samples in those cells. Include after `push.medium`.

const uint kSampled = 0, kRead = 1;

uint markWord(uint set, uvec3 brick) {
    const uint row = (push.medium.bricks.x + 31) / 32;
    return ((set * push.medium.bricks.z + brick.z) * push.medium.bricks.y + brick.y) * row + brick.x / 32;
}
