// The particles' medium at a place, linear between the nodes of the shared grid (server/methods/grid/medium_grid.h).
// Include after `push.medium`, `push.albedo`, the buffers `float nodes[]` and `uint marks[]` are declared.

// True if all nodes around the place are in the grid and its brick has medium. `at`: in nodes.
bool isInNodes(vec3 at, uvec3 size) {
    if (any(lessThan(at, vec3(1))) || any(greaterThanEqual(at, vec3(size - 2)))) return false;
    const uvec3 brick = uvec3(at) / kSlabTile;
    return (marks[markWord(kSampled, brick)] >> (brick.x % 32) & 1) != 0;
}

// Extinction (1/m) at x, and what scatters each colour.
float mediumAt(vec3 x, out vec3 scattering) {
    const vec3 at = (x - push.medium.origin) / push.medium.spacing, t = fract(at);
    const uvec3 size = push.medium.bricks * kSlabTile;
    scattering = vec3(0);
    if (!isInNodes(at, size)) return 0;
    const uvec3 cell = uvec3(at);
    const uint row = size.x, sheet = size.y * row, plane = size.z * sheet;
    const uint first = cell.z * sheet + cell.y * row + cell.x;
    float value[4];
    for (uint q = 0; q < mediumQuantities(kOneAlbedo); ++q) {
        const uint n = first + q * plane;
        const vec4 below = vec4(nodes[n], nodes[n + 1], nodes[n + row], nodes[n + row + 1]);
        const uint m = n + sheet;
        const vec4 above = vec4(nodes[m], nodes[m + 1], nodes[m + row], nodes[m + row + 1]);
        const vec4 here = mix(below, above, t.z);
        value[q] = max(tick.extinction * mix(mix(here.x, here.y, t.x), mix(here.z, here.w, t.x), t.y), 0);
    }
    scattering = kOneAlbedo ? value[kExtinction] * push.albedo
                            : vec3(value[kScattering], value[kScattering + 1], value[kScattering + 2]);
    return value[kExtinction];
}
