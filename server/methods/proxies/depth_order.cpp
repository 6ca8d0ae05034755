#include "server/methods/proxies/depth_order.h"

#include <algorithm>

#include "server/methods/proxies/furthest_depths.h"
#include "shaders/cull_comp.h"
#include "shaders/draw_arguments_comp.h"

namespace brume {

using gpu::storageBuffer;

namespace {

constexpr float kDiagonal = 1.41421357f; // diagonal of a square of side 1

// True: the order is of this eye and this picture alone. The head's other eye, and the finer picture after a coarse
// one, see past other edges.
bool isOwn(const EyeInputs& in) { return in.step == 1 && !in.for_both_eyes; }

} // namespace

DepthOrder::DepthOrder(const gpu::Device& device, uint32_t capacity)
    : device_(device), cull_(device, {VK_SHADER_STAGE_COMPUTE_BIT, cull_comp, "cull"}, {{gpu::kIdHasOpaque, false}}),
      draw_arguments_(device, {VK_SHADER_STAGE_COMPUTE_BIT, draw_arguments_comp, "draw_arguments"}),
      sort_(device, capacity) {
    const VkDeviceSize bytes = std::max(capacity, 1u) * sizeof(uint32_t);
    keys_ = gpu::Buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "depth keys");
    values_ = gpu::Buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                          gpu::Memory::device, "depth order");
    arguments_ = gpu::Buffer(device, sizeof(gpu::DrawArguments),
                             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                 VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                             gpu::Memory::device, "draw arguments");
}

void DepthOrder::record(gpu::Commands& commands, const EyeInputs& in, Support support, uint32_t vertices,
                        uint32_t particles_per_group, const FurthestDepths* furthest) {
    if (in.order_ready) return;
    const bool leaves_out = furthest && isOwn(in);
    if (leaves_out && !cull_hidden_)
        cull_hidden_ = {device_, {VK_SHADER_STAGE_COMPUTE_BIT, cull_comp, "cull"}, {{gpu::kIdHasOpaque, true}}};
    const VkCommandBuffer cmd = commands.handle();
    {
        const gpu::Commands::Pass pass(commands, "cull", in.view);
        gpu::everythingBefore(cmd); // the scratch is shared by all eyes
        vkCmdFillBuffer(cmd, arguments_.handle(), 0, sizeof(gpu::DrawArguments), 0);
        gpu::transferToCompute(cmd);
        if (leaves_out) furthest->record(commands, in);
        const struct {
            uint32_t full_support;
            float sprite; // radii of the ball around a sprite, per scale; 0: no sprites
        } push{support == Support::sphere             ? 1u
               : support == Support::even_tetrahedron ? 2u
                                                      : 0u,
               support == Support::sprite
                   ? std::max(kDiagonal * in.shared->settings->sprites.size, 1.0f) * in.shared->tick->balls.radius
                   : 0};
        const gpu::Resource depths = leaves_out ? storageBuffer("Furthest", furthest->buffer())
                                                : in.resources.storage("Particles").as("Furthest"); // is not read
        (leaves_out ? cull_hidden_ : cull_)
            .bind(commands, in.resources,
                  {storageBuffer("Keys", keys_), storageBuffer("Values", values_),
                   storageBuffer("Arguments", arguments_), depths},
                  push);
        vkCmdDispatch(cmd, gpu::groups(in.medium->count, 64), 1, 1);
        gpu::computeToCompute(cmd);
        const uint32_t drawn[] = {vertices, particles_per_group};
        draw_arguments_.bind(commands, {storageBuffer("Arguments", arguments_)}, drawn);
        vkCmdDispatch(cmd, 1, 1, 1);
    }
    const gpu::Commands::Pass pass(commands, "sort", in.view);
    sort_.record(commands, keys_, values_, in.medium->count);
    gpu::computeToDraw(cmd);
}

} // namespace brume
