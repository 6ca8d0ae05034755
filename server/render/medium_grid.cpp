#include "server/render/medium_grid.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "server/render/line_bins.h"
#include "shaders/grid_bins_comp.h"
#include "shaders/grid_fill_comp.h"

namespace brume {
namespace {

constexpr float kLinearVariance = 1.0f / 6, kCubicVariance = 1.0f / 3; // of what interpolates, spacings^2
constexpr float kRim = 3;                                              // nodes beyond the medium that its samples read

gpu::MediumGrid gridOf(const MediumExtent& extent, float spacing, bool cubic) {
    gpu::MediumGrid grid{};
    grid.spacing = spacing;
    grid.variance = cubic ? kCubicVariance : kLinearVariance;
    const glm::vec3 first = glm::floor(extent.lo / spacing) - kRim, last = glm::ceil(extent.hi / spacing) + kRim;
    grid.origin = first * spacing;
    // Beyond any that fits where the medium is enormous: to be refused, not to be wrapped around.
    grid.bricks = glm::uvec3(glm::ceil(glm::min(last - first + 1.0f, glm::vec3(1e6f)) / float(gpu::kSlabTile)));
    return grid;
}

uint32_t markBytes(const gpu::MediumGrid& grid) {
    return 2 * gpu::groups(grid.bricks.x, 32) * grid.bricks.y * grid.bricks.z * uint32_t(sizeof(uint32_t));
}

// Makes `buffer` hold at least `bytes`; what it held is lost.
void grow(gpu::Buffer& buffer, const gpu::Device& device, VkDeviceSize bytes, const char* name) {
    if (!buffer || buffer.size() < bytes)
        buffer = gpu::Buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                             gpu::Memory::device, name);
}

bool same(const gpu::MediumGrid& a, const gpu::MediumGrid& b) {
    return a.origin == b.origin && a.spacing == b.spacing && a.bricks == b.bricks && a.variance == b.variance;
}

} // namespace

gpu::MediumGrid mediumGrid(const MediumExtent& extent, const RenderSettings& settings) {
    const float spacing = settings.grid > 0 ? settings.grid : kGridSpacing;
    return gridOf(extent, spacing * extent.deviation, isCubic(settings));
}

uint64_t gridBytes(const gpu::MediumGrid& grid, bool one_albedo) {
    constexpr uint64_t kNodes = uint64_t(gpu::kSlabTile) * gpu::kSlabTile * gpu::kSlabTile;
    return uint64_t(grid.bricks.x) * grid.bricks.y * grid.bricks.z * kNodes * (one_albedo ? 1 : 4) * sizeof(float);
}

std::string gridRefusal(const MediumExtent& extent, const RenderSettings& settings) {
    const gpu::MediumGrid grid = mediumGrid(extent, settings);
    const uint64_t bytes = gridBytes(grid, extent.one_albedo);
    if (bytes <= kMostGridBytes) return {};
    const glm::vec3 size = extent.hi - extent.lo;
    return fmt::format("nodes {:.3g} m apart over {:.3g} x {:.3g} x {:.3g} m would take {:.3g} MiB, at most {} are allowed",
                       grid.spacing, size.x, size.y, size.z, double(bytes) / (1 << 20), kMostGridBytes >> 20);
}

GridPass::GridPass(const gpu::Device& device)
    : device_(device), bins_program_(device, {VK_SHADER_STAGE_COMPUTE_BIT, grid_bins_comp, "grid_bins"}),
      fill_program_(device, {VK_SHADER_STAGE_COMPUTE_BIT, grid_fill_comp, "grid_fill"}) {}

void GridPass::record(gpu::Commands& commands, const Inputs& in) {
    gpu::MediumGrid grid = mediumGrid(*in.extent, *in.settings);
    while (gridBytes(grid, in.extent->one_albedo) > kMostGridBytes)
        grid = gridOf(*in.extent, 1.25f * grid.spacing, isCubic(*in.settings));
    if (version_ == in.version && same(grid, grid_) && one_albedo_ == in.extent->one_albedo) return;
    version_ = in.version;
    grid_ = grid;
    one_albedo_ = in.extent->one_albedo;
    const uint32_t words = gpu::groups(in.count, 32), lines = grid.bricks.x + grid.bricks.y + grid.bricks.z;
    grow(members_, device_, in.count * sizeof(gpu::SlabMember), "grid members");
    const VkDeviceSize bin_bytes = lineBinBytes(lines, in.count);
    grow(bins_, device_, bin_bytes, "grid bins");
    grow(nodes_, device_, gridBytes(grid, one_albedo_), "grid nodes");
    grow(marks_, device_, markBytes(grid), "grid marks");

    const VkCommandBuffer cmd = commands.handle();
    {
        const gpu::Commands::Pass pass(commands, "grid bins");
        gpu::everythingBefore(cmd); // the last tick's viewers have read it
        vkCmdFillBuffer(cmd, marks_.handle(), 0, markBytes(grid), 0);
        vkCmdFillBuffer(cmd, bins_.handle(), 0, bin_bytes, 0);
        gpu::transferToCompute(cmd);
        bins_program_.bind(commands,
                           {in.tick, gpu::storageBuffer(2, *in.particles), gpu::storageBuffer(3, members_),
                            gpu::storageBuffer(4, bins_), gpu::storageBuffer(5, marks_)},
                           grid);
        vkCmdDispatch(cmd, words, 1, 1);
        gpu::computeToCompute(cmd);
    }
    const gpu::Commands::Pass pass(commands, "grid");
    fill_program_.bind(commands,
                       {in.tick, gpu::storageBuffer(2, members_), gpu::storageBuffer(3, nodes_), gpu::storageBuffer(4, bins_),
                        gpu::storageBuffer(5, marks_)},
                       grid);
    vkCmdDispatch(cmd, grid.bricks.x, grid.bricks.y, grid.bricks.z * (one_albedo_ ? 1 : 4));
    gpu::computeToCompute(cmd);
}

} // namespace brume
