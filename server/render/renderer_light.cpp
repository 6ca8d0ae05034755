// Renderer: the light on particles, for viewers who draw by themselves.
#include <algorithm>

#include "server/render/renderer.h"

namespace brume {

// The passes of a frame that come before its views, and the light on particles.
void Renderer::submitLight(Submission& s, const Simulation& simulation, const RenderSettings& settings,
                           std::span<const gpu::Particle> groups) {
    begin(simulation, &settings);
    s.uniforms_.atLeast(device_, UniformBlocks::bytes(1, hues_.size()),
                        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload,
                        "uniforms");
    upload_.take(simulation, scene_, now_, objects_.all(), {}, s.particles_);
    gatherTick();
    const UniformBlocks blocks(s.uniforms_, 1);
    upload_.writeBlocks(blocks, hues_, shared_.resources);
    EffectInputs in = effectInputs(simulation, {}, {});
    const std::span<const gpu::Particle> lit = groups.empty() ? upload_.list() : groups;
    MediumView grouped{gpu::Resources(&shared_.resources), uint32_t(groups.size()), 0, &upload_.extent()};
    in.fitted = groups.empty() ? &upload_.all() : &grouped;
    if (!groups.empty()) {
        s.groups_.atLeast(device_, groups.size_bytes(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::upload,
                          "groups upload");
        groups_.atLeast(device_, groups.size_bytes(),
                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::device,
                        "groups of particles");
        std::ranges::copy(groups, s.groups_.mapped<gpu::Particle>(groups.size()).begin());
        s.groups_.flush();
        grouped.resources.give(gpu::storageBuffer("Particles", groups_, 0, groups.size_bytes()));
        for (uint32_t hue = 0; hue < hues_.size(); ++hue) {
            gpu::Tick tick = hues_[hue].of(upload_.tick());
            tick.particle_count = uint32_t(groups.size());
            blocks.setLevel(hue, 0, tick);
        }
    }
    const VkDeviceSize bytes = lit.size() * sizeof(gpu::ParticleFit);
    in.fits_stride = (std::max<VkDeviceSize>(bytes, 1) + 255) / 256 * 256; // aligned for any device
    const VkDeviceSize all = hues_.size() * in.fits_stride;
    fits_.atLeast(device_, all, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                  gpu::Memory::device, "particle fits");
    s.fits_bytes_.atLeast(device_, all, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback,
                          "particle fits readback");
    in.fits = &fits_;
    for (const auto& effect : effects_) effect->prepare(in, shared_);
    const VkCommandBuffer cmd = s.commands.begin();
    upload_.record(s.commands, s.particles_);
    if (!groups.empty()) {
        gpu::everythingBefore(cmd);
        const VkBufferCopy copy{0, 0, groups.size_bytes()};
        vkCmdCopyBuffer(cmd, s.groups_.handle(), groups_.handle(), 1, &copy);
        gpu::transferToCompute(cmd);
    }
    for (const auto& effect : effects_) effect->recordTick(s.commands, in, shared_);
    s.fits_.particles.assign(lit.begin(), lit.end());
    s.fits_.hues = hues_;
    s.fits_.objects.assign(objects_.all().begin(), objects_.all().end());
    s.fits_.tick = upload_.tick();
    s.fits_.fits.clear();
    for (uint32_t hue = 0; hue < hues_.size(); ++hue) {
        if (hues_.size() > 1) gpu::everythingBefore(cmd);
        shared_.later_hue = hue > 0;
        upload_.enter(blocks, hue);
        enterHue(hue);
        if (!groups.empty()) grouped.resources.give(blocks.level(hue, 0));
        for (const auto& effect : effects_) effect->recordHue(s.commands, in, shared_);
        s.fits_.fits.push_back(s.fits_bytes_.mapped<gpu::ParticleFit>(s.fits_.particles.size(), hue * in.fits_stride));
    }
    gpu::computeToTransfer(cmd);
    const VkBufferCopy copy{0, 0, all};
    vkCmdCopyBuffer(cmd, fits_.handle(), s.fits_bytes_.handle(), 1, &copy);
    gpu::transferToHost(cmd);
    s.commands.submit();
    upload_.submitted();
}

} // namespace brume
