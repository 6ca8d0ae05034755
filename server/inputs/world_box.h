// The box of world space in which light is worth keeping: around objects, particles, balls of fog and local lights.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/inputs/medium_view.h"
#include "server/inputs/tick_inputs.h"

namespace brume {

inline constexpr double kLitAround = 10; // m, around a local light, at most

// m. With fog that fills no ball and nothing else it holds nothing.
inline Bounds3 worldBox(const TickInputs& tick, const MediumView& medium) {
    Bounds3 box = tick.objects_bounds;
    if (medium.count > 0) box.add({medium.extent->lo, medium.extent->hi});
    for (uint32_t i = 0; i < tick.tick->fog_count; ++i) {
        const gpu::Fog& fog = tick.tick->fogs[i];
        if (fog.radius < kNoBall) box.add({fog.centre - fog.radius, fog.centre + fog.radius});
    }
    for (const gpu::LocalLight& light : tick.lights) {
        const glm::dvec3 at = light.position;
        const double reach = std::min(double(light.reach), kLitAround);
        box.add({at - reach, at + reach});
    }
    return box;
}

} // namespace brume
