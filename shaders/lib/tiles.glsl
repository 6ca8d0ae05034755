// Tiles of an eye's picture, and blocks of tiles. Include after lib/eye.glsl.
const uvec2 kTile = uvec2(16, 8); // pixels

// A cone around the directions through pixels lo ... hi: the unit direction through their middle, and the largest
// distance between it and another unit direction.
struct PixelCone {
    vec3 direction;
    float chord;
};
PixelCone pixelCone(uvec2 lo, uvec2 hi) {
    const vec2 a = vec2(min(lo, eye.size)), b = vec2(min(hi, eye.size));
    PixelCone cone;
    cone.direction = normalize(rayDirection(0.5 * (a + b)));
    cone.chord = 0;
    for (int i = 0; i < 4; ++i) { // the largest distance is at a corner
        const vec2 corner = vec2((i & 1) == 0 ? a.x : b.x, (i & 2) == 0 ? a.y : b.y);
        cone.chord = max(cone.chord, distance(cone.direction, normalize(rayDirection(corner))));
    }
    return cone;
}
