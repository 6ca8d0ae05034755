// The particles' medium at a place. Include after what lib/extinction_nodes.glsl needs, kOneAlbedo and `push.albedo`.
#include "shaders/lib/extinction_nodes.glsl"

// Extinction (1/m) at x, and what scatters each colour.
float mediumAt(vec3 x, out vec3 scattering) {
    const vec3 at = (x - push.medium.origin) / push.medium.spacing;
    const uvec3 size = push.medium.bricks * kSlabTile;
    scattering = vec3(0);
    if (!isInNodes(at, size)) return 0;
    const float extinction = nodeValue(kExtinction, at, size);
    scattering = kOneAlbedo ? extinction * push.albedo
                            : vec3(nodeValue(kScattering, at, size), nodeValue(kScattering + 1, at, size),
                                   nodeValue(kScattering + 2, at, size));
    return extinction;
}
