// Whether planes, boxes and spheres lie between two places, or around one. Include after lib/objects.glsl and
// lib/object_tree.glsl.
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"

// True if the way from x to x + dir meets a box or a sphere, or if x lies in it.
bool blocks(Opaque o, vec3 x, vec3 dir) {
    if (o.kind == kSphere) { // the closest point first: no cancellation far away
        const float square = dot(dir, dir), closest = dot(o.centre - x, dir) / square;
        const vec3 off = o.centre - x - closest * dir;
        const float beside = o.half_size.x * o.half_size.x - dot(off, off), half_chord = sqrt(max(beside, 0) / square);
        return beside > 0 && closest + half_chord > 0 && closest - half_chord < 1;
    }
    const vec3 p = toObject(o, x - o.centre), inverse = inverseOf(toObject(o, dir));
    const vec3 a = (-o.half_size - p) * inverse, b = (o.half_size - p) * inverse;
    const vec3 t0 = min(a, b), t1 = max(a, b);
    return max(max(t0.x, t0.y), max(t0.z, 0)) < min(min(t1.x, t1.y), min(t1.z, 1));
}

// True if one lies between x and x + dir. own: true if a box or a sphere that x lies in counts, too.
bool isBehindBody(vec3 x, vec3 dir, bool own) {
    vec3 n;
    [[dont_unroll]] for (uint o = 0; o < tick.plane_count; ++o)
        if (hitObject(objects[o], x, dir, n) < 1) return true;
    const vec3 inverse = inverseOf(dir);
    const uint count = objectNodes();
    [[dont_unroll]] for (uint i = 0; i < count;) {
        const ObjectNode node = object_nodes[i];
        const bool passed = passes(node, x, inverse);
        if (passed && node.object != kInnerNode) {
            const Opaque o = objects[node.object];
            if (own ? blocks(o, x, dir) : hitObject(o, x, dir, n) < 1) return true;
        }
        i = passed ? i + 1 : node.next;
    }
    return false;
}

// True if x lies inside a box or a sphere.
bool isInSolid(vec3 x) {
    const uint count = objectNodes();
    [[dont_unroll]] for (uint i = 0; i < count;) {
        const ObjectNode node = object_nodes[i];
        const bool inside = all(greaterThanEqual(x, node.lo)) && all(lessThanEqual(x, node.hi));
        if (inside && node.object != kInnerNode) {
            const Opaque o = objects[node.object];
            const vec3 from = x - o.centre;
            if (o.kind == kSphere ? dot(from, from) < o.half_size.x * o.half_size.x
                                  : all(lessThan(abs(toObject(o, from)), o.half_size)))
                return true;
        }
        i = inside ? i + 1 : node.next;
    }
    return false;
}
