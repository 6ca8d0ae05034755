#include "server/effects/particle_light/particle_light.h"

#include <algorithm>

#include "shaders/particle_light_comp.h"

namespace brume {

ParticleLight::ParticleLight(const gpu::Device& device, uint32_t capacity, bool ellipsoids)
    : program_(device, {VK_SHADER_STAGE_COMPUTE_BIT, particle_light_comp, "particle_light"},
               {{gpu::kIdEllipsoids, ellipsoids}}),
      lights_(device, std::max(capacity, 1u) * sizeof(gpu::ParticleLight),
              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::device,
              "particle light") {}

void ParticleLight::record(gpu::Commands& commands, const gpu::Resources& medium, uint32_t count, float tolerance) {
    if (count == 0) return;
    const VkCommandBuffer cmd = commands.handle();
    const gpu::Commands::Pass pass(commands, "particle light");
    gpu::everythingBefore(cmd); // the last tick's viewers have read it
    program_.bind(commands, medium, {gpu::storageBuffer("ParticleLights", lights_)}, tolerance);
    vkCmdDispatch(cmd, gpu::groups(count, 64), 1, 1);
    gpu::computeToCompute(cmd);
}

} // namespace brume
