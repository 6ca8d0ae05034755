// Marches a ray through its slices and writes the light that is scattered toward the eye up to each face, and the
// optical depth of the medium before it. A lane is a ray. Include after `eye`, `push.froxels`,
// `vec4 volume[]`, `float furthest[]`, kHasOpaque, and
//   void addSlice(float near, float far, inout vec3 scattered, out float depth): what the medium between two view
//     depths scatters toward the eye, per unit of its own opacity over its depth, and its optical depth
#include "shaders/lib/eye.glsl"
#include "shaders/lib/froxel_depth.glsl"
#include "shaders/lib/march_ray.glsl"
#include "shaders/shared/transmittance.h"

uvec2 own_ray;         // the lane's ray, numbered across and down
uint added_slices = 0; // so many slices of the ray were added

bool hasParticles() { return push.froxels.particles != 0; }

vec2 pixelOfRay(uvec2 ray) { return float(push.froxels.pixels) * vec2(ray + uvec2(0, push.froxels.first_row)) + 0.5; }

void addSlice(float near, float far, inout vec3 scattered, out float depth);

// The largest view depth that pixels read which this ray is a neighbour of.
float furthestAround(vec2 at) {
    if (!kHasOpaque) return kEndless;
    const ivec2 tiles = (ivec2(eye.size) + int(kPixelTile) - 1) / int(kPixelTile);
    const ivec2 lo = clamp(ivec2(at - float(push.froxels.pixels)) / int(kPixelTile), ivec2(0), tiles - 1),
                hi = clamp(ivec2(at + float(push.froxels.pixels)) / int(kPixelTile), ivec2(0), tiles - 1);
    float most = 0;
    for (int y = lo.y; y <= hi.y; ++y)
        for (int x = lo.x; x <= hi.x; ++x) most = max(most, furthest[y * tiles.x + x]);
    return most;
}

void march(uvec2 ray) {
    own_ray = ray;
    if (any(greaterThanEqual(ray, push.froxels.rays))) return;
    const vec2 at = pixelOfRay(ray);
    aimRay(at);
    const float end = furthestAround(at);
    vec3 light = vec3(0);
    float passed = 0, near = faceDepth(0);
    volume[froxelAt(0, ray)] = vec4(0);
    // One face lies behind the furthest surface: pixels interpolate up to it.
    [[dont_unroll]] for (uint slice = 0; slice < push.froxels.slices && near <= end; ++slice) {
        const float far = faceDepth(float(slice + 1));
        vec3 scattered = vec3(0);
        ray_slice = slice;
        float depth = 0;
        if (passed < 30) { // behind that nothing is seen
            addSlice(near, far, scattered, depth);
            added_slices = slice + 1;
        }
        // The source is even within the slice: what it adds is exact then (Hillaire 2015).
        light += scattered * (exp(-passed) * phi(depth));
        passed += depth;
        volume[froxelAt(slice + 1, ray)] = vec4(light, passed);
        near = far;
    }
}
