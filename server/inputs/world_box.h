// The box of world space in which light is worth keeping: around objects, particles, balls of fog and local lights.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/inputs/medium_view.h"
#include "server/inputs/tick_inputs.h"

namespace brume {

inline constexpr double kLitAround = 10;  // m around a local light, at most: where its light is kept
inline constexpr double kSeenAround = 40; // m around a local light, at most: where it is drawn

// m. Around local lights, as far as they reach, but at most so far.
inline Bounds3 lampBox(const TickInputs& tick, double most) {
    Bounds3 box;
    for (const gpu::LocalLight& light : tick.lights) {
        const double reach = std::min(double(light.range), most);
        box.add({glm::dvec3(light.position) - reach, glm::dvec3(light.position) + reach});
    }
    return box;
}

// m. With fog that fills no ball and nothing else it holds nothing.
inline Bounds3 worldBox(const TickInputs& tick, const MediumView& medium) {
    Bounds3 box = tick.objects_bounds;
    if (medium.count > 0) box.add({medium.extent->lo, medium.extent->hi});
    for (uint32_t i = 0; i < tick.tick->fog_count; ++i) {
        const gpu::Fog& fog = tick.tick->fogs[i];
        if (fog.radius < kNoBall) box.add({fog.centre - fog.radius, fog.centre + fog.radius});
    }
    box.add(lampBox(tick, kLitAround));
    return box;
}

} // namespace brume
