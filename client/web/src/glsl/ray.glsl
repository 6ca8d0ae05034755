// Rays of a grid. Distances on a ray count from where it is closest to the medium's middle.
uniform vec3 corner, across, rise; // of unit view depth: through the grid's lower left corner, and the steps from there
uniform vec3 middle;               // of the medium, m from the eye
uniform float radius;              // of the medium, m

vec3 rayThrough(vec2 at) { return corner + at.x * across + at.y * rise; }
