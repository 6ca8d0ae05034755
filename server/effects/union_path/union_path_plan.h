// Cost of light behind the union of balls. Methods that ask for it count its work. Surfaces behind balls need it, too,
// which no plan counts.
#pragma once

#include "server/plan/cost_model.h"

namespace brume::costs {

inline constexpr CostInfo kUnionPath{"union_path", "union path", 1500}; // particles

} // namespace brume::costs
