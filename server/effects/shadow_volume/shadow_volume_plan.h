// Work of the volumetric shadow map.
#pragma once

#include "server/effects/effect_plan.h"

namespace brume {

namespace costs {
// Particles x cells that they reach, plus the cells.
inline constexpr CostInfo kShadowVolume{"shadow_volume", "shadow volume", 0.12};
inline constexpr CostInfo kTetrahedraShadow{"tetrahedra_shadow", "tetrahedra shadow", 23}; // texels x tetrahedra behind
} // namespace costs

// Of a map of this resolution, which the plan chooses, once per tick for all viewers.
Work shadowWork(const PlanScene& scene, const PlanScene::Shadow& shadow);

} // namespace brume
