// Directions on a square, by the octahedron (Meyer et al., On Floating-Point Normal Vectors, 2010): one vertex is the
// middle, the opposite one all four corners.

// In [-1, 1]^2 from a unit direction.
vec2 toOctahedron(vec3 w) {
    const vec3 p = w / (abs(w.x) + abs(w.y) + abs(w.z));
    const vec2 folded = (1 - abs(p.zx)) * vec2(p.x < 0 ? -1 : 1, p.z < 0 ? -1 : 1);
    return p.y < 0 ? folded : p.xz;
}

// The other way.
vec3 fromOctahedron(vec2 at) {
    const float y = 1 - abs(at.x) - abs(at.y);
    const vec2 folded = (1 - abs(at.yx)) * vec2(at.x < 0 ? -1 : 1, at.y < 0 ? -1 : 1);
    const vec2 xz = y < 0 ? folded : at;
    return normalize(vec3(xz.x, y, xz.y));
}
