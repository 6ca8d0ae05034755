// Cost of light behind the union of balls. Its work is that of the methods that ask for it.
#pragma once

#include "server/plan/cost_model.h"

namespace brume::costs {

inline constexpr CostInfo kUnionPath{"union_path", "union path", 1500}; // particles

} // namespace brume::costs
