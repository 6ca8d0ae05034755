// What the particles in each cell of the six fluxes are made of, where they differ or emit light.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "shaders/shared/types.h"

namespace brume {

// As shaders/flux_cells.comp reads it.
struct CellMatter {
    glm::vec3 albedo{0}, emission{0}; // emission: radiance per optical depth
    bool operator==(const CellMatter&) const = default;
};

// True: cells of the fluxes have their own. `one_albedo`: all particles have the same albedo.
inline bool hasCellMatter(const gpu::Tick& tick, bool one_albedo) {
    return tick.multiple.cells > 0 && (!one_albedo || tick.emission != glm::vec3(0));
}

// Means over the particles' extinction in each cell of a grid with `side` cells along each side of the volumetric
// shadow map: [z][y][x], x and y along LightMap::x and y, z the way that the sun's light goes. A particle counts as at
// least half a cell wide, and up to three standard deviations from its centre; cells without any have the mean of all.
// `sums`: memory that is used again. Precondition: `out` has side^3 elements.
struct CellSum {
    CellMatter times_extinction;
    float extinction = 0;
};
void cellMatter(const gpu::Tick& tick, std::span<const gpu::Particle> particles, uint32_t side,
                std::vector<CellSum>& sums, std::span<CellMatter> out);

} // namespace brume
