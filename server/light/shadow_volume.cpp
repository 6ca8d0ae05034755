#include "server/light/shadow_volume.h"

#include <algorithm>

#include "shaders/shadow_particles_comp.h"
#include "shaders/shadow_volume_comp.h"

namespace brume {

using gpu::storageBuffer;

ShadowVolume::ShadowVolume(const gpu::Device& device, uint32_t capacity)
    : device_(device), particles_(device, {VK_SHADER_STAGE_COMPUTE_BIT, shadow_particles_comp, "shadow_particles"}),
      volume_(device, {VK_SHADER_STAGE_COMPUTE_BIT, shadow_volume_comp, "shadow_volume"}) {
    const VkDeviceSize count = std::max(capacity, 1u);
    light_particles_ = gpu::Buffer(device, count * sizeof(gpu::LightParticle), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                   gpu::Memory::device, "light particles");
    columns_ = gpu::Buffer(device, count * kPlanes * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device,
                           "light columns");
}

void ShadowVolume::record(gpu::Commands& commands, const gpu::Resource& tick_block, const gpu::Tick& tick,
                          const gpu::Buffer& particles) {
    const VkCommandBuffer cmd = commands.handle();
    const gpu::Commands::Pass pass(commands, "shadow volume");
    const uint32_t layers = gpu::groups(tick.shadow_slices - 1, kNewPlanesPerLayer);
    if (!image_ || image_.extent().width != tick.shadow_size || image_.layers() != layers) {
        image_ = gpu::Image(device_,
                            {VK_FORMAT_R32G32B32A32_SFLOAT,
                             {tick.shadow_size, tick.shadow_size},
                             VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                             layers},
                            "shadow volume");
        gpu::toGeneral(cmd, image_);
    }
    gpu::everythingBefore(cmd); // the last tick's viewers have read it
    for (uint32_t first_plane = 0; first_plane + 1 < tick.shadow_slices; first_plane += kPlanes - 1) {
        particles_.bind(cmd,
                        {tick_block, storageBuffer(2, particles), storageBuffer(3, light_particles_), storageBuffer(4, columns_)},
                        first_plane);
        vkCmdDispatch(cmd, gpu::groups(std::max(tick.particle_count, 1u), 64), 1, 1);
        gpu::computeToCompute(cmd);
        volume_.bind(cmd,
                     {tick_block, storageBuffer(3, light_particles_), storageBuffer(4, columns_), gpu::storageImage(5, image_)},
                     first_plane);
        const uint32_t tiles = gpu::groups(tick.shadow_size, kTile);
        vkCmdDispatch(cmd, tiles, tiles, 1);
        gpu::computeToCompute(cmd); // the next group of planes uses the same scratch
    }
    gpu::computeToDraw(cmd);
}

} // namespace brume
