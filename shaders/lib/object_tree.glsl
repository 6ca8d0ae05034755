// The tree of boxes and spheres, and what asks nodes of any tree. To walk it, begin with node 0. After a node that is
// entered comes the next one in the buffer, after one that is left out the node `next`.
#include "shaders/blocks/tick.glsl"

uint objectNodes() { return max(2 * (tick.opaque_count - tick.plane_count), 1) - 1; }

vec3 inverseOf(vec3 dir) { return 1 / mix(dir, vec3(1e-12), lessThan(abs(dir), vec3(1e-12))); }

// True if the ray origin + t dir, t in 0 ... 1, passes through a node. `inverse`: inverseOf(dir).
bool passes(ObjectNode node, vec3 origin, vec3 inverse) {
    const vec3 a = (node.lo - origin) * inverse, b = (node.hi - origin) * inverse;
    const vec3 t0 = min(a, b), t1 = max(a, b);
    return max(max(t0.x, t0.y), max(t0.z, 0)) <= min(min(t1.x, t1.y), min(t1.z, 1));
}

// True if a node may meet the triangle between a light and two places. `normal`: of the triangle, of any length, or 0.
bool meetsTriangle(ObjectNode node, vec3 light, vec3 a, vec3 b, vec3 normal) {
    const vec3 lo = min(light, min(a, b)), hi = max(light, max(a, b));
    if (any(greaterThan(node.lo, hi)) || any(lessThan(node.hi, lo))) return false;
    const vec3 half_size = 0.5 * (node.hi - node.lo), to = 0.5 * (node.lo + node.hi) - light;
    // 1e-5: what rounding may add to the distance from the plane.
    return abs(dot(normal, to)) <= dot(abs(normal), half_size + 1e-5 * abs(to));
}
