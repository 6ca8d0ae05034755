// Local lights: what arrives from one, and which may matter to a pixel. Include after lib/fog.glsl, lib/objects.glsl
// and `eye`.
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/has_local_lights.glsl"
#include "shaders/lib/lamp.glsl"
#include "shaders/lib/object_tree.glsl"
#include "shaders/lib/mesh.glsl"

// Optical depth of fog between a light and a place.
float fogFrom(LocalLight light, vec3 away, float distance) {
    return fogBetween(light.position, away / max(distance, 1e-20), 1, 0, distance);
}

// True if an object other than `skip` hides the light from a place.
bool isHidden(LocalLight light, vec3 x, uint skip) {
    const vec3 dir = light.position - x, inverse = inverseOf(dir);
    vec3 n;
    [[dont_unroll]] for (uint o = 0; o < tick.plane_count; ++o)
        if (o != skip && hitObject(objects[o], x, dir, n) < 1) return true;
    [[dont_unroll]] for (uint i = 0; i < objectNodes();) {
        const ObjectNode node = object_nodes[i];
        const bool passed = passes(node, x, inverse);
        const bool leaf = passed && node.object != kInnerNode && node.object != skip;
        if (leaf && hitObject(objects[node.object], x, dir, n) < 1) return true;
        i = passed ? i + 1 : node.next;
    }
    return false;
}
