// What follows from the medium's band limit: how far apart rays, slabs and shaded pixels may be, in its standard deviations
// (physics: "Order-independent slabs"). What the choices err is measured by tools/bench/sweeps/methods.toml.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/scene.h"

namespace brume {

// Spacing of rays and of shaded pixels in projected standard deviations of the medium, at most.
inline constexpr float kRaysPerDeviation = 0.85f;
// Spacing of shaded pixels in widths of the phase function's lobe, at most.
inline constexpr float kPixelsPerLobe = 0.1f;
// Thickness of slabs in standard deviations, where their number is left open.
inline constexpr float kSlabsPerDeviation = 0.7f;
// Pixels between rays that are used.
inline constexpr uint32_t kRates[] = {1, 2, 4, 6, 8, 12, 16};
// Numbers of slabs along a ray.
inline constexpr uint32_t kLeastSlabs = 8, kMostSlabs = 256;
// Spacings by which rates may exceed what the plan says, so that they stay while cameras move a little: less than a step.
inline constexpr double kFarther = 1.15;

// Pixels between rays in a view where the medium's deviation has `part` of the pixels that it has where they are `rate`: rays as
// far apart in deviations, up to kFarther times.
inline uint32_t rateFor(uint32_t rate, double part) {
    if (part > 1 / kFarther && part < kFarther) return rate;
    uint32_t own = 1;
    for (const uint32_t r : kRates)
        if (r <= kFarther * part * rate) own = r;
    return own;
}

// Pixels between those that are shaded: 1, 2, 4 or 8, as RenderSettings::shading says, or as both limits allow. No more than
// `rate`, pixels between rays. `deviation`: the medium's, in pixels; `lobe`: 1 - |asymmetry| rad in pixels, the width of a
// Henyey-Greenstein lobe, infinite without one. Its error is below a hundredth of a level on average
// (tests/gpu/coarse_test.cpp).
inline uint32_t shadingStep(const RenderSettings& settings, uint32_t rate, float deviation, float lobe) {
    uint32_t step = settings.shading;
    if (step == 0) {
        const float most = std::min(kRaysPerDeviation * deviation, kPixelsPerLobe * lobe);
        step = most >= 8 ? 8 : most >= 4 ? 4 : most >= 2 ? 2 : 1;
    }
    while (step > rate) step /= 2; // nodes around the picture are within a cell of it
    return step;
}

} // namespace brume
