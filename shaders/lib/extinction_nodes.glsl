// The particles' extinction at a place, linear between the nodes of the shared grid
// (server/methods/grid/medium_grid.h). Include after `push.medium`, the buffers `float nodes[]` and `uint marks[]` are
// declared, and lib/grid_marks.glsl.
#include "shaders/blocks/tick.glsl"

// True if all nodes around the place are in the grid and its brick has medium. `at`: in nodes.
bool isInNodes(vec3 at, uvec3 size) {
    if (any(lessThan(at, vec3(1))) || any(greaterThanEqual(at, vec3(size - 2)))) return false;
    const uvec3 brick = uvec3(at) / kSlabTile;
    return (marks[markWord(kSampled, brick)] >> (brick.x % 32) & 1) != 0;
}

// A quantity of the medium (shared/field.h) at a place for which isInNodes().
float nodeValue(uint quantity, vec3 at, uvec3 size) {
    const vec3 t = fract(at);
    const uvec3 cell = uvec3(at);
    const uint row = size.x, sheet = size.y * row, plane = size.z * sheet;
    const uint n = cell.z * sheet + cell.y * row + cell.x + quantity * plane, m = n + sheet;
    const vec4 below = vec4(nodes[n], nodes[n + 1], nodes[n + row], nodes[n + row + 1]);
    const vec4 above = vec4(nodes[m], nodes[m + 1], nodes[m + row], nodes[m + row + 1]);
    const vec4 here = mix(below, above, t.z);
    return max(tick.extinction * mix(mix(here.x, here.y, t.x), mix(here.z, here.w, t.x), t.y), 0);
}

// 1/m, at x.
float extinctionAt(vec3 x) {
    const vec3 at = (x - push.medium.origin) / push.medium.spacing;
    const uvec3 size = push.medium.bricks * kSlabTile;
    return isInNodes(at, size) ? nodeValue(kExtinction, at, size) : 0;
}
