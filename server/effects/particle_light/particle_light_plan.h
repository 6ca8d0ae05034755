// Cost of light cached on the particles. Its work is that of the methods that ask for it.
#pragma once

#include "server/plan/cost_model.h"

namespace brume::costs {

inline constexpr CostInfo kParticleLight{"particle_light", "particle light", 130}; // particles

} // namespace brume::costs
