#include "server/effects/object_shadow/mesh_shadow.h"

#include <algorithm>

#include "shaders/mesh_pyramid_comp.h"
#include "shaders/mesh_shadow_frag.h"
#include "shaders/mesh_shadow_vert.h"

namespace brume {

MeshShadow::MeshShadow(const gpu::Device& device)
    : device_(device), nearest_(device, VK_FILTER_NEAREST),
      heights_program_(device,
                       {{VK_SHADER_STAGE_VERTEX_BIT, mesh_shadow_vert, "mesh_shadow"},
                        {VK_SHADER_STAGE_FRAGMENT_BIT, mesh_shadow_frag, "mesh_shadow"}},
                       {.formats = {VK_FORMAT_R32_SFLOAT}, .blend = gpu::Blend::largest}),
      pyramid_program_(device, mesh_pyramid_comp, "mesh_pyramid") {}

void MeshShadow::record(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick) {
    makeImage(commands.handle(), tick.mesh_size);
    if (tick.triangle_count > 0) draw(commands, shared, tick);
}

void MeshShadow::makeImage(VkCommandBuffer cmd, uint32_t size) {
    if (heights_ && heights_.extent().width == size) return;
    heights_ = gpu::Image(device_,
                          {VK_FORMAT_R32_SFLOAT,
                           {size, size},
                           VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                               VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                          "mesh heights");
    gpu::toGeneral(cmd, heights_);
    pyramid_.atLeast(device_, std::max<VkDeviceSize>(VkDeviceSize(size) * size / 3, 32) * sizeof(glm::vec2),
                     VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "mesh pyramid");
}

void MeshShadow::draw(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick) {
    const gpu::Commands::Pass pass(commands, "mesh shadow");
    const VkCommandBuffer cmd = commands.handle();
    gpu::everythingBefore(cmd);
    const VkClearColorValue nothing{{-1e30f, 0, 0, 0}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(cmd, heights_.handle(), VK_IMAGE_LAYOUT_GENERAL, &nothing, 1, &all);
    gpu::everythingBefore(cmd);
    gpu::beginDrawing(cmd, {tick.mesh_size, tick.mesh_size}, {&heights_});
    heights_program_.with().bind(commands, shared, {});
    vkCmdDraw(cmd, 3 * tick.triangle_count, 1, 0, 0);
    vkCmdEndRendering(cmd);
    for (uint32_t level = 1; tick.mesh_size >> level > 0; ++level) {
        gpu::everythingBefore(cmd);
        pyramid_program_.with().bind(
            commands, shared,
            {gpu::sampledImage("mesh_heights", heights_, nearest_), gpu::storageBuffer("MeshPyramid", pyramid_)},
            level);
        const uint32_t groups = gpu::groups(tick.mesh_size >> level, 8);
        vkCmdDispatch(cmd, groups, groups, 1);
    }
    gpu::everythingBefore(cmd);
}

} // namespace brume
