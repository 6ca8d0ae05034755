#include "server/render/drawn_cells.h"

#include <algorithm>

#include "shaders/drawn_cells_comp.h"

namespace brume {
namespace {

// The largest error of a cubic that is accepted, in standard deviations of the medium: of the length of medium in front
// of a surface, plus that in shadow.
constexpr float kSame = 0.25f;

} // namespace

DrawnCells::DrawnCells(const gpu::Device& device) : program_(device, drawn_cells_comp, "drawn_cells") {}

void DrawnCells::clear(gpu::Commands& commands, const EyeInputs& coarse) const {
    const VkClearColorValue nothing{{0, 0, 0, 1}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands.handle(), coarse.target->radiance.handle(), VK_IMAGE_LAYOUT_GENERAL, &nothing, 1,
                         &all);
    gpu::everythingBefore(commands.handle());
}

void DrawnCells::interpolate(gpu::Commands& commands, const EyeInputs& fine, const EyeInputs& coarse) {
    const gpu::Commands::Pass pass(commands, "cells", fine.view);
    const VkCommandBuffer cmd = commands.handle();
    const gpu::Eye& eye = fine.block->eye;
    const MediumExtent& extent = *fine.medium->extent;
    const DepthRange depths = depthRange(extent, eye.position, -eye.back);
    const struct {
        float near, far, same;
    } push{std::max(depths.near, eye.near_depth), std::max(depths.far, eye.near_depth), kSame * extent.deviation};
    gpu::everythingBefore(cmd);
    const gpu::Sampler& nearest = *fine.shared->nearest;
    program_.with({{gpu::kIdStep, coarse.step}})
        .bind(commands, fine.resources,
              {gpu::sampledImage("node_medium", coarse.target->radiance, nearest),
               gpu::sampledImage("node_depth", coarse.target->view_depth, nearest)},
              push);
    const uint32_t side = 8 * coarse.step;
    vkCmdDispatch(cmd, gpu::groups(fine.size.width, side), gpu::groups(fine.size.height, side), 1);
    gpu::everythingBefore(cmd);
}

} // namespace brume
