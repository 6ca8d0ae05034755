// Rays of a grid. Distances on a ray count from where it is closest to the medium's middle.
// corner: the direction of the grid's lower left corner, of unit view depth. across, rise: from one ray to the next.
uniform vec3 corner, across, rise;
uniform vec3 middle;  // the medium's middle, m from the eye
uniform float radius; // the medium's radius, m

vec3 rayThrough(vec2 at) { return corner + at.x * across + at.y * rise; }
