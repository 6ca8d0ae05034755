// Coarse nodes of the medium's grid, twice as far apart as the others: they hold the particles that are large enough
// (MediumGrid::least_coarse), as coefficients of a cubic B-spline. Coarse node c lies at node 2 c - 2, along each
// axis, so that all nodes have the coarse ones around them. Include after `push.medium`.

// A brick reads coarse nodes from the first of half of its own place on, seven along each axis.
const uint kHalfTile = kSlabTile / 2, kCoarseOfTile = kHalfTile + 3;

uvec3 coarseBricks() { return push.medium.bricks / 2 + 1; }
vec3 inCoarse(vec3 node) { return 0.5 * node + 1; }
// The coarse bricks whose nodes bricks `first` to `last` read.
ivec3 firstCoarse(ivec3 first) { return first * int(kHalfTile) / int(kSlabTile); }
ivec3 lastCoarse(ivec3 last) { return (last * int(kHalfTile) + int(kCoarseOfTile) - 1) / int(kSlabTile); }
