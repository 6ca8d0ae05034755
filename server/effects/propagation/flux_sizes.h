// Sizes of what propagation keeps on the device for each hue (server/effects/propagation/propagation.h).
#pragma once

#include <cstdint>

#include "server/effects/propagation/cell_matter.h"
#include "shaders/shared/glow.h"
#include "shaders/shared/multiple.h"

namespace brume {

inline constexpr uint32_t kFluxes = 6; // number of fluxes that pass a cell, one each way along each axis
inline constexpr uint64_t kLampBytes = 13 * sizeof(float); // shaders/lib/flux_lamps.glsl

struct FluxSizes {
    // Bytes of the buffers; the images are as large as `fluence` and `glow`.
    uint64_t cells = 0, fluxes = 0, fluence = 0, surfaces = 0, matter = 0, lamps = 0, direct = 0, glow = 0;
    uint64_t ofHue() const { return cells + fluxes + 2 * fluence + surfaces + lamps + direct + 2 * glow; }
};

// `side`: cells along each side of the finest grid. `matter`: true where cells have their own (cell_matter.h), which
// all hues share. `onto_surfaces`: lightsSurfaces().
inline FluxSizes fluxSizes(uint32_t side, uint32_t channels, bool matter, bool onto_surfaces) {
    const auto cellsOf = [](uint64_t n) { return n * n * n; };
    uint64_t count = 0; // of the cells of all grids
    for (uint32_t level = 0; level < gpu::kFluxLevels; ++level) count += cellsOf(side >> level);
    return {count * (1 + (matter ? 3 : 2) * channels) * sizeof(float),
            count * channels * kFluxes * sizeof(float),
            cellsOf(side) * channels * 4 * sizeof(float),
            cellsOf(side / 2) * channels * 5 * sizeof(float),
            matter ? cellsOf(side) * sizeof(CellMatter) : 0,
            onto_surfaces ? gpu::kLamps * kLampBytes : 0,
            onto_surfaces ? cellsOf(side) * channels * 4 * sizeof(float) : 0,
            onto_surfaces ? cellsOf(gpu::kGlowSide) * channels * 4 * sizeof(float) : 0};
}

} // namespace brume
