// Rays through the triangles of meshes, by their tree. To walk it, begin with the first node of an order. After a node
// that is entered comes the next one in the buffer, after one that is left out the node `next`.
#include "shaders/blocks/meshes.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/has_meshes.glsl"

const float kNoTriangle = 1e30;  // distance where none is hit
const float kPassed = 1.000002;  // distances in a node's box differ by roundings: as a factor

uint meshNodes() { return 2 * tick.triangle_count - 1; }

struct MeshRay {
    vec3 origin, dir; // a place is origin + t dir
    vec3 inverse;     // 1 / dir
    vec3 x, y;        // span the plane across the ray
    uint first;       // index of the first node in the ray's order
};

MeshRay meshRay(vec3 origin, vec3 dir) {
    const vec3 inverse = 1 / mix(dir, vec3(1e-12), lessThan(abs(dir), vec3(1e-12)));
    const vec3 helper = abs(dir.y) < 0.7 * length(dir) ? vec3(0, 1, 0) : vec3(1, 0, 0), x = cross(dir, helper);
    const uint orders = tick.triangle_count > kMostInAllOrders ? kFewMeshOrders : kMeshOrders;
    const uvec3 negative = uvec3(lessThan(dir, vec3(0))) * uvec3(1, 4, 2);
    const uint order = (negative.x | negative.y | negative.z) & (orders - 1);
    return MeshRay(origin, dir, inverse, x, cross(dir, x), order * meshNodes());
}

// Where the ray meets a node's box that is larger by `reach` (m) all around: t of begin and end.
vec2 rangeIn(ObjectNode node, MeshRay ray, float reach) {
    const vec3 a = (node.lo - reach - ray.origin) * ray.inverse, b = (node.hi + reach - ray.origin) * ray.inverse;
    const vec3 t0 = min(a, b), t1 = max(a, b);
    return vec2(max(t0.x, max(t0.y, t0.z)), kPassed * min(t1.x, min(t1.y, t1.z)));
}

// Distance t at which the ray goes through the triangle; kNoTriangle if it does not. No ray passes between two
// triangles that share an edge: they see its corners at the same places across the ray, and compute the same side of
// the edge.
float hitTriangle(Triangle triangle, MeshRay ray) {
    const vec3 a = triangle.a - ray.origin, b = triangle.b - ray.origin, c = triangle.c - ray.origin;
    precise const vec2 p = vec2(dot(ray.x, a), dot(ray.y, a));
    precise const vec2 q = vec2(dot(ray.x, b), dot(ray.y, b));
    precise const vec2 r = vec2(dot(ray.x, c), dot(ray.y, c));
    precise const vec3 sides = vec3(r.x * q.y - r.y * q.x, p.x * r.y - p.y * r.x, q.x * p.y - q.y * p.x);
    const float sum = sides.x + sides.y + sides.z;
    const bool inside = all(greaterThanEqual(sides, vec3(0))) || all(lessThanEqual(sides, vec3(0)));
    if (!inside || sum == 0) return kNoTriangle;
    const vec3 along = vec3(dot(ray.dir, a), dot(ray.dir, b), dot(ray.dir, c));
    return dot(sides, along) / (sum * dot(ray.dir, ray.dir));
}

// True if the ray goes through a triangle other than `skip` at a t in begin ... end.
bool meetsMesh(vec3 origin, vec3 dir, float begin, float end, uint skip) {
    const MeshRay ray = meshRay(origin, dir);
    const uint last = ray.first + meshNodes();
    [[dont_unroll]] for (uint i = ray.first; i < last;) {
        const ObjectNode node = mesh_nodes[i];
        const vec2 range = rangeIn(node, ray, 0);
        const bool met = max(range.x, begin) <= min(range.y, end);
        if (met && node.object != kInnerNode && node.object != skip) {
            const float t = hitTriangle(triangles[node.object], ray);
            if (t > begin && t < end) return true;
        }
        i = met ? i + 1 : node.next;
    }
    return false;
}

// True if a triangle other than `skip` is between a place and where it is lit from. `dir`: to there, to be taken
// `end` times. `distance`: of the place from the eye, m, in which it may be rounded.
bool isShadowedByMesh(vec3 x, vec3 dir, float end, uint skip, float distance) {
    const float rounding = 2e-6 * (abs(x.x) + abs(x.y) + abs(x.z) + distance);
    return meetsMesh(x, dir, rounding * inversesqrt(dot(dir, dir)), end, skip);
}
