// Pixels and directions of one eye; include after `eye` is declared.

// World direction through the pixel position, of unit view depth: a point at view depth z lies at eye.position + z *
// direction.
vec3 rayDirection(vec2 pixel) { return eye.ray + pixel.x * eye.ray_right + pixel.y * eye.ray_down; }
