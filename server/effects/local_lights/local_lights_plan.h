// Costs and memory of points and spots.
#pragma once

#include "server/plan/work.h"

namespace brume {

namespace costs {
inline constexpr CostInfo kLocalLightDepth{"light_directions", "local light depth",
                                           1.6}; // directions of all lights with shadows x particles
inline constexpr CostInfo kLocalLight{"local_light", "local light bins, local light", 51}; // localPieces()
inline constexpr CostInfo kLitSurfaces{"lit_surfaces", "opaque", 0.6}; // pixels in a light's range x (1 + objects)
} // namespace costs

// Of lights that rays do not hold: the pieces that rays of pixels in their ranges are cut into: at cones and fogs, and
// at the slabs of particles.
double localPieces(const ViewWork& view, const RenderSettings& settings);
// Slabs of rays x lamps whose light these hold.
double lampsOnRays(const ViewWork& view, const RenderSettings& settings);

inline constexpr uint64_t kLitBytesOfPixel = 3 * sizeof(float);

} // namespace brume
