// Optical depth of the particles between a local light and a place, from its volume (local_light_depth.comp): linear
// between four directions and two distances. Include after a buffer `float light_depths[]` is declared.
#include "shaders/lib/octahedron.glsl"

float particlesFrom(LocalLight light, vec3 away, float distance) {
    if (light.volume == kNoVolume) return 0;
    const float shell = (distance - light.volume_near) / light.volume_step;
    if (!(shell > 0)) return 0;
    const vec2 at = (toOctahedron(away / distance) * 0.5 + 0.5) * float(kLightVolume - 1);
    const uvec2 node = min(uvec2(at), uvec2(kLightVolume - 2));
    const uint near = min(uint(shell), kLightShells - 2);
    const float along = min(shell - float(near), 1);
    const vec2 part = at - vec2(node);
    const uint first = ((light.volume * kLightVolume + node.y) * kLightVolume + node.x) * kLightShells + near;
    const uint row = kLightVolume * kLightShells;
    const vec4 here = vec4(light_depths[first], light_depths[first + kLightShells], light_depths[first + row],
                           light_depths[first + row + kLightShells]);
    const vec4 next = vec4(light_depths[first + 1], light_depths[first + kLightShells + 1],
                           light_depths[first + row + 1], light_depths[first + row + kLightShells + 1]);
    const vec4 depths = mix(here, next, along);
    const vec2 rows = mix(depths.xz, depths.yw, part.x);
    return tick.extinction * mix(rows.x, rows.y, part.y);
}
