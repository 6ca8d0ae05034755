// Pixels and directions of one eye; include after `eye` is declared.

// World direction through the pixel position, of unit view depth: a point at view depth z lies at eye.position + z * direction.
vec3 rayDirection(vec2 pixel) {
    const vec2 ndc = pixel / vec2(eye.size) * 2 - 1;
    return (ndc.x * eye.tan_x) * eye.right - (ndc.y * eye.tan_y) * eye.up - eye.back;
}
