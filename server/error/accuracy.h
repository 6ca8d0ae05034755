// Accuracy: a measure of how accurate pictures should be by the plan's laws. It is coarse, so that pictures which
// differ little are measured together.
#pragma once

#include <algorithm>
#include <cmath>

namespace brume {

// Twice the base-2 logarithm of the relative RMSE that the laws predict; larger is worse.
inline double exactAccuracyOf(double law) { return 2 * std::log2(std::clamp(law, 1e-9, 1e9)); }
inline int accuracyOf(double law) { return int(std::lround(exactAccuracyOf(law))); }

} // namespace brume
