#include "server/render/drawn_cells.h"

#include <algorithm>

#include "server/render/background.h"
#include "shaders/drawn_cells_comp.h"

namespace brume {
namespace {

// Of a deviation of the medium: how far a cubic may be off where the medium ends, or its shadow.
constexpr float kSame = 0.25f;

} // namespace

void DrawnCells::begin(gpu::Commands& commands, const EyeInputs& nodes) const {
    nodes.background->record(commands, nodes);
    const VkClearColorValue nothing{{0, 0, 0, 1}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands.handle(), nodes.radiance->handle(), VK_IMAGE_LAYOUT_GENERAL, &nothing, 1, &all);
    gpu::everythingBefore(commands.handle());
}

void DrawnCells::record(gpu::Commands& commands, const EyeInputs& in) {
    const gpu::Commands::Pass pass(commands, "cells", in.view);
    const VkCommandBuffer cmd = commands.handle();
    const gpu::Eye& eye = in.block->eye;
    const DepthRange depths = depthRange(*in.extent, eye.position, -eye.back);
    const struct {
        float near, far, same;
        uint32_t first_caster;
    } push{std::max(depths.near, eye.near_depth), std::max(depths.far, eye.near_depth), kSame * in.extent->deviation,
           in.first_caster};
    const EyeInputs& nodes = *in.nodes;
    gpu::ComputeProgram& program = programs_[nodes.step];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, drawn_cells_comp, "drawn_cells"},
                                      {{gpu::kIdStep, nodes.step}});
    gpu::everythingBefore(cmd);
    program.bind(commands,
                 {in.tick, in.eye, gpu::storageImage(2, *in.radiance), gpu::storageImage(3, *in.view_depth),
                  gpu::sampledImage(4, *nodes.radiance, *in.nearest), gpu::sampledImage(5, *nodes.view_depth, *in.nearest),
                  gpu::uniformBuffer(6, *in.objects, 0, in.objects->size())},
                 push);
    const uint32_t side = 8 * nodes.step;
    vkCmdDispatch(cmd, gpu::groups(in.size.width, side), gpu::groups(in.size.height, side), 1);
    gpu::everythingBefore(cmd);
}

} // namespace brume
