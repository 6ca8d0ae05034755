#include "server/effects/object_shadow/opaque_shadow.h"

#include "shaders/opaque_shadow_frag.h"
#include "shaders/opaque_shadow_vert.h"

namespace brume {

OpaqueShadow::OpaqueShadow(const gpu::Device& device) : device_(device) {
    const gpu::ShaderCode shaders[] = {{VK_SHADER_STAGE_VERTEX_BIT, opaque_shadow_vert, "opaque_shadow"},
                                       {VK_SHADER_STAGE_FRAGMENT_BIT, opaque_shadow_frag, "opaque_shadow"}};
    gpu::GraphicsInfo graphics;
    graphics.formats = {VK_FORMAT_R32_SFLOAT};
    graphics.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP;
    graphics.blend = gpu::Blend::largest;
    program_ = gpu::GraphicsProgram(device, shaders, graphics);
}

void OpaqueShadow::record(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick,
                          std::span<const gpu::Opaque> objects) {
    const VkCommandBuffer cmd = commands.handle();
    const gpu::Commands::Pass pass(commands, "opaque shadow");
    const VkExtent2D size{tick.map.opaque_size, tick.map.opaque_size};
    if (!image_ || image_.extent().width != tick.map.opaque_size) {
        image_ = gpu::Image(device_,
                            {VK_FORMAT_R32_SFLOAT, size,
                             VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                 VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                            "opaque shadow");
        gpu::toGeneral(cmd, image_);
    }
    gpu::everythingBefore(cmd);
    const VkClearColorValue nothing{{-1e30f, 0, 0, 0}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(cmd, image_.handle(), VK_IMAGE_LAYOUT_GENERAL, &nothing, 1, &all);
    gpu::everythingBefore(cmd);
    gpu::beginDrawing(cmd, size, {&image_});
    for (uint32_t i = 0; i < objects.size(); ++i) {
        if (objects[i].kind == gpu::kPlane) continue; // nothing lies below it
        program_.bind(commands, shared, {}, i);
        vkCmdDraw(cmd, 4, 1, 0, 0);
    }
    vkCmdEndRendering(cmd);
    gpu::everythingBefore(cmd);
}

} // namespace brume
