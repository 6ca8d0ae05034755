#include "server/light/opaque_shadow.h"

#include "shaders/opaque_shadow_comp.h"

namespace brume {

OpaqueShadow::OpaqueShadow(const gpu::Device& device)
    : device_(device), program_(device, {VK_SHADER_STAGE_COMPUTE_BIT, opaque_shadow_comp, "opaque_shadow"}) {}

void OpaqueShadow::record(gpu::Commands& commands, const gpu::Resource& tick_block, const gpu::Tick& tick,
                          const gpu::Buffer& objects) {
    if (image_ && tick.to_light == last_.to_light && tick.opaque_size == last_.opaque_size) return;
    last_ = tick;
    const VkCommandBuffer cmd = commands.handle();
    const gpu::Commands::Pass pass(commands, "opaque shadow");
    if (!image_ || image_.extent().width != tick.opaque_size) {
        image_ = gpu::Image(device_,
                            {VK_FORMAT_R32_SFLOAT,
                             {tick.opaque_size, tick.opaque_size},
                             VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
                            "opaque shadow");
        gpu::toGeneral(cmd, image_);
    }
    gpu::everythingBefore(cmd);
    program_.bind(cmd, {tick_block, gpu::storageBuffer(1, objects), gpu::storageImage(2, image_)});
    vkCmdDispatch(cmd, gpu::groups(tick.opaque_size, 8), gpu::groups(tick.opaque_size, 8), 1);
    gpu::computeToCompute(cmd);
    gpu::computeToDraw(cmd);
}

} // namespace brume
