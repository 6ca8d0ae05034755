// Optical depth of the particles between a local light and a place, from its volume (local_light_depth.comp): linear
// between four directions and two distances.
#include "shaders/blocks/light_depths.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/light_directions.glsl"

float particlesFrom(LocalLight light, vec3 away, float distance) {
    if (light.volume == kNoVolume) return 0;
    const float shell = (distance - light.volume_near) / light.volume_step;
    if (!(shell > 0)) return 0;
    const vec3 w = away / distance;
    if (dot(w, light.volume_axis) < light.volume_cosine) return 0; // no particles are there
    const uint shells = light.volume_shells, row = light.volume_side * shells;
    const vec2 at = (toLightSquare(light, w) * 0.5 + 0.5) * float(light.volume_side - 1);
    const uvec2 node = min(uvec2(at), uvec2(light.volume_side - 2));
    const uint near = min(uint(shell), shells - 2);
    const float along = min(shell - float(near), 1);
    const vec2 part = at - vec2(node);
    const uint first = light.volume + node.y * row + node.x * shells + near;
    const vec4 here = vec4(light_depths[first], light_depths[first + shells], light_depths[first + row],
                           light_depths[first + row + shells]);
    const vec4 next = vec4(light_depths[first + 1], light_depths[first + shells + 1],
                           light_depths[first + row + 1], light_depths[first + row + shells + 1]);
    const vec4 depths = mix(here, next, along);
    const vec2 rows = mix(depths.xz, depths.yw, part.x);
    return tick.extinction * mix(rows.x, rows.y, part.y);
}

// The same, but beside the light's cone that of the cone's rim.
float particlesFromBeside(LocalLight light, vec3 away, float distance) {
    if (light.volume == kNoVolume) return 0;
    const vec3 w = away / max(distance, 1e-20);
    const float cosine = light.volume_cosine + 1e-5, along = dot(w, light.volume_axis);
    if (along >= cosine) return particlesFrom(light, away, distance);
    const vec3 aside = w - along * light.volume_axis;
    const vec3 rim = cosine * light.volume_axis + sqrt(max(1 - cosine * cosine, 0)) * normalize(aside);
    return particlesFrom(light, distance * rim, distance);
}
