// Cost and memory of shafts of the sun's light.
#pragma once

#include "server/plan/cost_model.h"

namespace brume {

namespace costs {
inline constexpr CostInfo kShafts{"shafts", "shafts", 9}; // pixels x (1 + ViewWork::shadowsMet())
} // namespace costs

inline constexpr uint64_t kShaftBytesOfPixel = 3 * sizeof(float);

} // namespace brume
