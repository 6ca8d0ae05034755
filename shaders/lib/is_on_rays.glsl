// Which points and spots the rays of a field hold the light of. Every pixel looks up the others, one by one. Include
// after lib/eye.glsl and lib/field_planes.glsl.
#include "shaders/shared/lamps.h"
#include "shaders/shared/types.h"

bool isOnRays(LocalLight light) {
    if (!kLampsOnRays) return false;
    // Two passes ask: one adds the light, the other leaves it out. `precise` rounds alike in both.
    precise const float depth = -dot(light.position - eye.position, eye.back);
    precise const float apart = float(grid.rate) * length(eye.ray_down);
    return raysHold(light.smooth_length, depth, apart, slabThickness(), grid.lamp_spacing);
}
