#include "server/methods/grid/node_grid_plan.h"

#include <fmt/format.h>

#include "server/gpu/binding_sizes.h"
#include "shaders/shared/field.h"

namespace brume {
namespace {

constexpr float kLinearVariance = 1.0f / 6, kCubicVariance = 1.0f / 3; // of what interpolates, spacings^2
constexpr float kRim = 3;                                              // nodes beyond the medium that its samples read

gpu::MediumGrid gridOf(const MediumExtent& extent, float spacing, bool cubic) {
    gpu::MediumGrid grid{};
    grid.spacing = spacing;
    grid.variance = cubic ? kCubicVariance : kLinearVariance;
    grid.least_coarse = cubic ? kNeverCoarse : kLeastCoarse;
    const glm::vec3 first = glm::floor(extent.lo / spacing) - kRim, last = glm::ceil(extent.hi / spacing) + kRim;
    grid.origin = first * spacing;
    // Beyond any that fits where the medium is enormous: to be refused, not to be wrapped around.
    grid.bricks = glm::uvec3(glm::ceil(glm::min(last - first + 1.0f, glm::vec3(1e6f)) / float(gpu::kSlabTile)));
    return grid;
}

uint64_t bytesOf(glm::uvec3 bricks, bool one_albedo) {
    constexpr uint64_t kNodes = uint64_t(gpu::kSlabTile) * gpu::kSlabTile * gpu::kSlabTile;
    return uint64_t(bricks.x) * bricks.y * bricks.z * kNodes * gpu::mediumQuantities(one_albedo) * sizeof(float);
}

} // namespace

gpu::MediumGrid mediumGrid(const MediumExtent& extent, const RenderSettings& settings, bool linear) {
    const float spacing = settings.grid.spacing != kAuto ? settings.grid.spacing : kGridSpacing;
    return gridOf(extent, spacing * extent.deviation, isCubic(settings) && !linear);
}

gpu::MediumGrid gridThatFits(const MediumExtent& extent, const RenderSettings& settings, bool linear) {
    gpu::MediumGrid grid = mediumGrid(extent, settings, linear);
    while (gridBytes(grid, extent.one_albedo) > gpu::kLargestBinding)
        grid = gridOf(extent, 1.25f * grid.spacing, isCubic(settings) && !linear);
    return grid;
}

uint64_t gridBytes(const gpu::MediumGrid& grid, bool one_albedo) { return bytesOf(grid.bricks, one_albedo); }

uint64_t coarseBytes(const gpu::MediumGrid& grid, bool one_albedo) { return bytesOf(coarseBricks(grid), one_albedo); }

std::string gridRefusal(const MediumExtent& extent, const RenderSettings& settings) {
    const gpu::MediumGrid grid = mediumGrid(extent, settings);
    const uint64_t bytes = gridBytes(grid, extent.one_albedo);
    if (bytes <= gpu::kLargestBinding) return {};
    const glm::vec3 size = extent.hi - extent.lo;
    return fmt::format(
        "nodes {:.3g} m apart over {:.3g} x {:.3g} x {:.3g} m would take {:.3g} MiB, at most {} are allowed",
        grid.spacing, size.x, size.y, size.z, double(bytes) / (1 << 20), gpu::kLargestBinding >> 20);
}

} // namespace brume
