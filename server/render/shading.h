// Which pixels of a picture without sharp edges are shaded; the others follow by cubic interpolation (shaders/present.comp).
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/scene.h"

namespace brume {

// Spacing of rays and of shaded pixels in projected standard deviations of the medium, at most.
inline constexpr float kRaysPerDeviation = 0.85f;
// And of shaded pixels in widths of the phase function's lobe.
inline constexpr float kPixelsPerLobe = 0.1f;

// Pixels between those that are shaded: 1, 2, 4 or 8, as RenderSettings::shading says, or as both limits allow. No more than
// `rate`, pixels between rays. `deviation`: the medium's, in pixels; `lobe`: 1 - |asymmetry| rad in pixels, the width of a
// Henyey-Greenstein lobe, infinite without one. What it errs is below a hundredth of a level on average
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
