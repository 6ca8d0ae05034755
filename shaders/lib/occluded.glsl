// Whether opaque objects lie between two places: planes, boxes, spheres and triangles. Include after
// lib/objects.glsl, lib/object_tree.glsl and lib/mesh.glsl.
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/behind_bodies.glsl"

// True if an object lies between x and x + dir. own: true if a box or a sphere that x lies in counts, too.
bool isOccluded(vec3 x, vec3 dir, bool own) {
    if (isBehindBody(x, dir, own)) return true;
    if (!kHasMeshes || tick.triangle_count == 0) return false;
    const float distance = length(dir); // along a unit vector: far lights would overflow otherwise
    return isShadowedByMesh(x, dir / max(distance, 1e-20), distance, kInnerNode, 0);
}
bool isOccluded(vec3 x, vec3 dir) { return isOccluded(x, dir, false); }
