// The boxes and spheres that the rays of one pixel hit first, where there are many. Include after lib/objects.glsl,
// lib/object_bins.glsl and lib/eye.glsl.
#include "shaders/blocks/objects.glsl"

const uint kPixelRays = 5; // rays of a pixel: through its centre, and its four samples

float body_depth[kPixelRays]; // view depth; kMiss if none is hit
uint body_hit[kPixelRays];    // index of the object

// True if a ray through any point of the pixel may hit the object. `off`: its centre from the eye; `pixel`: most
// distance of the rays from the middle one at view depth 1, m.
bool mayHit(Opaque o, uint kind, vec3 off, vec3 middle, float pixel) {
    const vec3 across = cross(off, middle);
    const float reach = bodyReach(o, kind) + pixel * length(off);
    return dot(across, across) <= reach * reach * dot(middle, middle);
}

// One walk for all rays of a pixel, from near objects to far ones: it ends where all that are left lie behind the hits.
// `kinds`: 1 for spheres only, 0 for boxes only, 2 for both.
void hitBodies(uint bin, uint kinds, vec3 middle, vec3 rays[kPixelRays], float pixel) {
    for (uint n = 0; n < kPixelRays; ++n) body_depth[n] = kMiss;
    float furthest = kMiss; // view depth of the farthest hit among the rays
    uint i;
    BinWalk walk = walkBin(bin);
    [[dont_unroll]] while (nextObject(walk, i)) {
        Opaque o = objects[i];
        if (kinds < 2) o.kind = kinds == 0 ? kBox : kSphere;
        const vec3 off = o.centre - eye.position;
        if (bodyBegin(o, o.kind, off) > 1.0001 * furthest) break;
        if (!mayHit(o, o.kind, off, middle, pixel)) continue;
        furthest = 0;
        [[unroll]] for (uint n = 0; n < kPixelRays; ++n) {
            vec3 normal;
            const float t = hitObject(o, eye.position, rays[n], normal);
            if (t >= eye.near_depth && t < body_depth[n]) {
                body_depth[n] = t;
                body_hit[n] = i;
            }
            furthest = max(furthest, body_depth[n]);
        }
    }
}
