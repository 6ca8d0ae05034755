// The sun past meshes by their height map (server/opaque/mesh_shadow.h).
#include "shaders/blocks/mesh_heights.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/has_meshes.glsl"

// Visibility of the sun past meshes from a light-space point: 1 or 0, from one texel.
float visibilityPastMeshes(vec3 at) {
    const vec2 texel = (at.xy - tick.mesh_lo) / (tick.mesh_hi - tick.mesh_lo) * float(tick.mesh_size);
    if (any(lessThan(texel, vec2(0))) || any(greaterThanEqual(texel, vec2(tick.mesh_size)))) return 1;
    return at.z >= texelFetch(mesh_heights, ivec2(texel), 0).r ? 1 : 0;
}
