// The triangles that the rays of one pixel hit first. Include after lib/mesh.glsl and lib/body_hits.glsl.
#include "shaders/blocks/meshes.glsl"

float mesh_depth[kPixelRays]; // view depth; kNoTriangle if none is hit
uint mesh_hit[kPixelRays];    // index of the triangle

// One walk for all rays of a pixel: they are at most `pixel` m apart from the middle one at view depth 1.
void hitMeshes(vec3 middle, vec3 rays[kPixelRays], float pixel) {
    const MeshRay ray = meshRay(eye.position, middle);
    MeshRay single[kPixelRays];
    for (uint n = 0; n < kPixelRays; ++n) {
        mesh_depth[n] = kNoTriangle;
        single[n] = meshRay(eye.position, rays[n]);
    }
    float furthest = kNoTriangle; // of the hits of all rays
    const uint last = ray.first + meshNodes();
    [[dont_unroll]] for (uint i = ray.first; i < last;) {
        const ObjectNode node = mesh_nodes[i];
        const vec3 half_size = 0.5 * (node.hi - node.lo), to = 0.5 * (node.lo + node.hi) - eye.position;
        const float deepest = max(dot(abs(eye.back), half_size) - dot(eye.back, to), 0);
        const vec2 range = rangeIn(node, ray, pixel * deepest);
        const bool met = max(range.x, eye.near_depth) <= min(range.y, furthest);
        if (met && node.object != kInnerNode) {
            const Triangle triangle = triangles[node.object];
            furthest = 0;
            for (uint n = 0; n < kPixelRays; ++n) {
                const float t = hitTriangle(triangle, single[n]);
                if (t >= eye.near_depth && t < mesh_depth[n]) {
                    mesh_depth[n] = t;
                    mesh_hit[n] = node.object;
                }
                furthest = max(furthest, mesh_depth[n]);
            }
        }
        i = met ? i + 1 : node.next;
    }
}
