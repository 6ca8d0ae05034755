// Light that has scattered more than once, at a place.
#include "shaders/blocks/fluence.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/multiple.h"

// Net flux and fluence of a channel at a place in the volumetric shadow map, linear between cells.
vec4 fluenceAt(uint channel, vec3 in_volume) {
    const float cells = float(tick.multiple.cells);
    const float z = clamp(in_volume.z / float(tick.map.slices - 1) * cells - 0.5, 0, cells - 1);
    const float below = min(floor(z), cells - 2), first = float(channel) * cells + below;
    return mix(textureLod(fluence, vec3(in_volume.xy, first), 0), textureLod(fluence, vec3(in_volume.xy, first + 1), 0),
               z - below);
}
