// Sampling distances that follow from the medium's band limit: of rays, slabs and shaded pixels, in the medium's
// standard deviations. tools/bench/sweeps/methods.toml measures the errors that these choices lead to.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/scene.h"

namespace brume {

// Most spacing of rays and of shaded pixels, in projected standard deviations of the medium.
inline constexpr float kRaysPerDeviation = 0.85f;
// Most spacing of shaded pixels, in widths of the phase function's lobe.
inline constexpr float kPixelsPerLobe = 0.1f;
// Thickness of slabs in standard deviations, if their number is left open.
inline constexpr float kSlabsPerDeviation = 0.7f;
// Pixels between rays: the rates that exist.
inline constexpr uint32_t kRates[] = {1, 2, 4, 6, 8, 12, 16};
// Limits of the number of slabs along a ray.
inline constexpr uint32_t kLeastSlabs = 8, kMostSlabs = 256;
// Factor by which a ray spacing may exceed the planned one, so that rates do not change while cameras move a little.
// Smaller than the ratio of any two rates.
inline constexpr double kFarther = 1.15;

// Pixels between rays for a view, from `rate`, that of the reference view. `part`: the medium's standard deviation in
// pixels, in this view / in the reference view. The spacing in deviations stays the same, within a factor of
// kFarther.
inline uint32_t rateFor(uint32_t rate, double part) {
    if (part > 1 / kFarther && part < kFarther) return rate;
    uint32_t own = 1;
    for (const uint32_t r : kRates)
        if (r <= kFarther * part * rate) own = r;
    return own;
}

// Pixels between shaded pixels: 1, 2, 4 or 8. RenderSettings::shading if it is given, otherwise the most that both
// limits above allow; never more than `rate`, the pixels between rays. `deviation`: the medium's, in pixels. `lobe`:
// width of the Henyey-Greenstein lobe, 1 - |asymmetry| rad, in pixels; infinite without one. The mean error is below
// 1/100 of an 8-bit level (tests/gpu/coarse_test.cpp).
inline uint32_t shadingStep(const RenderSettings& settings, uint32_t rate, float deviation, float lobe) {
    uint32_t step = settings.shading;
    if (step == 0) {
        const float most = std::min(kRaysPerDeviation * deviation, kPixelsPerLobe * lobe);
        step = most >= 8 ? 8 : most >= 4 ? 4 : most >= 2 ? 2 : 1;
    }
    while (step > rate) step /= 2; // nodes around the picture are within a cell of it
    return step;
}

// Pixels between those whose local light and shafts are computed where these are smooth: 1 or 4. `shading`:
// RenderSettings::shading. Particles must not be smaller than the step.
inline uint32_t pixelStep(uint32_t shading, uint32_t rate, bool particles) {
    constexpr uint32_t kStep = 4;
    return (!particles || rate >= kStep) && (shading == kAuto || shading >= kStep) ? kStep : 1;
}

} // namespace brume
