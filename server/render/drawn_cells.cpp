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
    struct {
        float near = 1e30f, far = 0, same;
        uint32_t first_caster;
    } push{.same = kSame * in.extent->deviation, .first_caster = in.first_caster};
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 corner = glm::mix(in.extent->lo, in.extent->hi, glm::vec3(i & 1, i >> 1 & 1, i >> 2));
        const float depth = glm::dot(eye.back, eye.position - corner);
        push.near = std::min(push.near, depth);
        push.far = std::max(push.far, depth);
    }
    push.near = std::max(push.near, eye.near_depth);
    push.far = std::max(push.far, eye.near_depth);
    const EyeInputs& nodes = *in.nodes;
    gpu::ComputeProgram& program = programs_[nodes.step];
    if (!program)
        program =
            gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, drawn_cells_comp, "drawn_cells"}, {{22, nodes.step}});
    gpu::everythingBefore(cmd);
    program.bind(cmd,
                 {in.tick, in.eye, gpu::storageImage(2, *in.radiance), gpu::storageImage(3, *in.view_depth),
                  gpu::sampledImage(4, *nodes.radiance, *in.nearest), gpu::sampledImage(5, *nodes.view_depth, *in.nearest),
                  gpu::uniformBuffer(6, *in.objects, 0, in.objects->size())},
                 push);
    const uint32_t side = 8 * nodes.step;
    vkCmdDispatch(cmd, gpu::groups(in.size.width, side), gpu::groups(in.size.height, side), 1);
    gpu::everythingBefore(cmd);
}

} // namespace brume
