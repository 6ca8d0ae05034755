// The height map of meshes under the sun, and its pyramid. Include after this is declared:
//   vec2 mesh_pyramid[]: least and largest height, of squares of 2, 4, 8 ... texels a side
#include "shaders/blocks/mesh_heights.glsl"
#include "shaders/blocks/tick.glsl"

// Index in the pyramid of a level's first square, from level 1 on. Before it there are
// size^2 (1/4 + 1/16 + ...) = size^2 (1 - 4^-(level - 1)) / 3 squares.
uint firstSquare(uint level) {
    const uint texels = tick.mesh_size * tick.mesh_size;
    return (texels - (texels >> (2 * level - 2))) / 3;
}

// Least and largest height in a square of 2^level texels a side.
vec2 meshHeights(uint level, ivec2 square) {
    const int side = int(tick.mesh_size >> level);
    if (any(lessThan(square, ivec2(0))) || any(greaterThanEqual(square, ivec2(side)))) return vec2(-1e30);
    if (level == 0) return texelFetch(mesh_heights, square, 0).rr;
    return mesh_pyramid[firstSquare(level) + uint(square.y * side + square.x)];
}
