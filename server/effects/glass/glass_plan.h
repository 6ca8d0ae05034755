// Cost and memory of sheets of glass.
#pragma once

#include "server/plan/cost_model.h"

namespace brume {

namespace costs {
inline constexpr CostInfo kGlass{"glass", "glass", 12}; // pixels x (1 + layers) x (1 + sheets)
} // namespace costs

inline constexpr uint64_t kGlassBytesOfPixel = 5 * sizeof(float);

} // namespace brume
