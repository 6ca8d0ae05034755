// Samples in spheres: the first ones, then those of grids, each with twice as many cells along an axis as the one
// before. Include after lib/radiance_inputs.glsl.
#include "shaders/shared/sphere_samples.h"

// Samples of a grid along each axis, and m between them.
uvec3 gridSize(int level) { return (push.cells << level) + 1; }
float gridCell(int level) { return push.cell / float(1 << level); }

// Index of the first sample of a grid; one after the last grid for push.levels.
uint firstOf(int level) {
    uint first = push.firsts;
    for (int i = 0; i < level; ++i) {
        const uvec3 size = gridSize(i);
        first += size.x * size.y * size.z;
    }
    return first;
}
uint sampleAt(uvec3 vertex, uvec3 size) { return (vertex.z * size.y + vertex.y) * size.x + vertex.x; }
