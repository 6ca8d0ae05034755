#include "server/methods/grid/medium_grid.h"

#include "server/inputs/line_bins.h"
#include "shaders/grid_bins_comp.h"
#include "shaders/grid_fill_comp.h"
#include "shaders/shared/field.h"

namespace brume {
namespace {

uint32_t markWords(glm::uvec3 bricks) { return gpu::groups(bricks.x, 32) * bricks.y * bricks.z; }

uint32_t markBytes(const gpu::MediumGrid& grid) { // as in shaders/lib/grid_marks.glsl
    return (2 * markWords(grid.bricks) + markWords(coarseBricks(grid))) * uint32_t(sizeof(uint32_t));
}

uint32_t linesOf(glm::uvec3 bricks) { return bricks.x + bricks.y + bricks.z; }

constexpr VkBufferUsageFlags kGridBuffer = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

bool same(const gpu::MediumGrid& a, const gpu::MediumGrid& b) {
    return a.origin == b.origin && a.spacing == b.spacing && a.bricks == b.bricks && a.variance == b.variance;
}

} // namespace

GridPass::GridPass(const gpu::Device& device, bool ellipsoids)
    : device_(device), ellipsoids_(ellipsoids),
      bins_program_(device, {VK_SHADER_STAGE_COMPUTE_BIT, grid_bins_comp, "grid_bins"},
                    {{gpu::kIdEllipsoids, ellipsoids}}),
      program_(device, grid_fill_comp, "grid_fill") {
    // A medium that moves may get coarse nodes, and lose them: all programs are compiled at once.
    coarseProgram(), fineProgram(true), fineProgram(false);
}

const gpu::Program& GridPass::coarseProgram() {
    return program_.with({{gpu::kIdLanes, device_.lanesTogether()},
                          {gpu::kIdLockstep, device_.lockstep()},
                          {gpu::kIdEllipsoids, ellipsoids_},
                          {gpu::kIdCoarse, true},
                          {gpu::kIdHasCoarse, true}});
}

const gpu::Program& GridPass::fineProgram(bool has_coarse) {
    return program_.with({{gpu::kIdLanes, device_.lanesTogether()},
                          {gpu::kIdLockstep, device_.lockstep()},
                          {gpu::kIdEllipsoids, ellipsoids_},
                          {gpu::kIdCoarse, false},
                          {gpu::kIdHasCoarse, has_coarse}});
}

void GridPass::record(gpu::Commands& commands, const MediumView& in, const RenderSettings& settings, bool linear) {
    volume_ = in.volume;
    if (volume_) {
        grid_ = volume_->grid();
        return;
    }
    const gpu::MediumGrid grid = gridThatFits(*in.extent, settings, linear);
    if (version_ == in.version && same(grid, grid_) && one_albedo_ == in.extent->one_albedo) return;
    version_ = in.version;
    grid_ = grid;
    one_albedo_ = in.extent->one_albedo;
    const uint32_t words = gpu::groups(in.count, 32), quantities = gpu::mediumQuantities(one_albedo_);
    const glm::uvec3 bricks = grid.bricks, coarse = coarseBricks(grid);
    const VkDeviceSize member_bytes = std::max<VkDeviceSize>(in.count * sizeof(gpu::SlabMember), 256);
    members_.atLeast(device_, member_bytes, kGridBuffer, gpu::Memory::device, "grid members");
    if (ellipsoids_)
        skews_.atLeast(device_, std::max<VkDeviceSize>(in.count * sizeof(gpu::Skew), 256), kGridBuffer,
                       gpu::Memory::device, "grid skews");
    const gpu::Resource skews = gpu::storageBuffer("Skews", ellipsoids_ ? skews_ : members_);
    const VkDeviceSize bin_bytes =
        std::max<VkDeviceSize>(lineBinBytes(linesOf(bricks) + linesOf(coarse), in.count), 256);
    bins_.atLeast(device_, bin_bytes, kGridBuffer, gpu::Memory::device, "grid bins");
    nodes_.atLeast(device_, gridBytes(grid, one_albedo_), kGridBuffer, gpu::Memory::device, "grid nodes");
    if (hasCoarse(grid))
        coarse_nodes_.atLeast(device_, coarseBytes(grid, one_albedo_), kGridBuffer, gpu::Memory::device,
                              "coarse nodes");
    marks_.atLeast(device_, markBytes(grid), kGridBuffer, gpu::Memory::device, "grid marks");

    const VkCommandBuffer cmd = commands.handle();
    {
        const gpu::Commands::Pass pass(commands, "grid bins");
        gpu::everythingBefore(cmd); // the last tick's viewers have read it
        vkCmdFillBuffer(cmd, marks_.handle(), 0, markBytes(grid), 0);
        vkCmdFillBuffer(cmd, bins_.handle(), 0, bin_bytes, 0);
        gpu::transferToCompute(cmd);
        bins_program_.bind(commands, in.resources,
                           {gpu::storageBuffer("Members", members_), skews, gpu::storageBuffer("Bins", bins_),
                            gpu::storageBuffer("Marks", marks_)},
                           grid);
        vkCmdDispatch(cmd, words, 1, 1);
        gpu::computeToCompute(cmd);
    }
    const auto fill = [&](const gpu::Program& program, glm::uvec3 size, const gpu::Buffer& into,
                          const gpu::Buffer& from) {
        program.bind(commands, in.resources,
                     {gpu::storageBuffer("Members", members_), skews, gpu::storageBuffer("Nodes", into),
                      gpu::storageBuffer("Bins", bins_), gpu::storageBuffer("Marks", marks_),
                      gpu::storageBuffer("CoarseNodes", from)},
                     grid);
        vkCmdDispatch(cmd, size.x, size.y, size.z * (gpu::kSlabTile / device_.lanesTogether()) * quantities);
        gpu::computeToCompute(cmd);
    };
    const bool has_coarse = hasCoarse(grid);
    const gpu::Commands::Pass pass(commands, "grid");
    if (has_coarse) // the last one is bound, but not read
        fill(coarseProgram(), coarse, coarse_nodes_, members_);
    fill(fineProgram(has_coarse), bricks, nodes_, has_coarse ? coarse_nodes_ : members_);
}

} // namespace brume
