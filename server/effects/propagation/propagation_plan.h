// Cost and memory of light of the sun that scatters more than once.
#pragma once

#include "common/render_settings.h"
#include "server/plan/cost_model.h"
#include "shaders/shared/types.h"

namespace brume {

namespace costs {
// Hues x channels x cells x iterations of all grids, with scattering = "propagation".
inline constexpr CostInfo kPropagation{"propagation", "propagation", 75};
} // namespace costs

// Bytes on the device for scattering = "propagation"; 0 without it. `hues`: huesOf().
uint64_t propagationMemory(const gpu::Tick& tick, const PropagationSettings& settings, bool one_albedo, uint32_t hues);

} // namespace brume
