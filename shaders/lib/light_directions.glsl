// Directions of a local light's volume on a square: all of them by the octahedron; those of a cone by equal areas on a
// disc (Lambert, 1772), with what is around the cone in the corners.
#include "shaders/lib/octahedron.glsl"

// Two unit vectors across a unit one (Duff et al., Building an Orthonormal Basis, Revisited, 2017).
mat2x3 across(vec3 axis) {
    const float s = axis.z < 0 ? -1 : 1, a = -1 / (s + axis.z), b = axis.x * axis.y * a;
    return mat2x3(vec3(1 + s * axis.x * axis.x * a, s * b, -s * axis.x), vec3(b, s + axis.y * axis.y * a, -axis.y));
}

// In [-1, 1]^2 from a unit direction; of a cone: one in it.
vec2 toLightSquare(LocalLight light, vec3 w) {
    if (light.volume_cosine < -1) return toOctahedron(w);
    return w * across(light.volume_axis) *
           inversesqrt(max((1 + dot(w, light.volume_axis)) * (1 - light.volume_cosine), 1e-12));
}

// The other way.
vec3 fromLightSquare(LocalLight light, vec2 at) {
    if (light.volume_cosine < -1) return fromOctahedron(at);
    const float part = 1 - light.volume_cosine, along = 1 - dot(at, at) * part;
    return normalize(along * light.volume_axis + across(light.volume_axis) * at * sqrt(max((1 + along) * part, 0)));
}
