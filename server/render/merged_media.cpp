#include "server/render/merged_media.h"

#include <algorithm>
#include <utility>

namespace brume {

void MergedMedia::choose(std::span<const gpu::Particle> ordered, bool moved, const gpu::Tick& tick,
                         const MediumExtent& extent, std::span<const EyeRequest> eyes, float merge) {
    of_eye_.assign(eyes.size(), nullptr);
    media_.clear();
    for (const auto& medium : all_) {
        medium->wanted = medium->fresh = false;
        if (moved || tick.falloff != falloff_) medium->exponent = kNoLevel;
    }
    falloff_ = tick.falloff;
    if (merge <= 0 || ordered.size() < kLargeMedium) return;
    for (size_t i = 0; i < eyes.size(); ++i) {
        const int exponent = mergeLevel(eyes[i].pose, eyes[i].width, eyes[i].height, extent, merge);
        if (exponent == kNoLevel) continue;
        Medium& medium = merged(ordered, exponent, tick.falloff);
        if (!medium.worth) continue;
        of_eye_[i] = &medium;
        if (std::exchange(medium.wanted, true)) continue;
        media_.push_back(&medium);
        medium.tick = tick;
        medium.tick.particle_count = uint32_t(medium.list.size());
        if (medium.fresh) medium.extent = mediumExtent(medium.list, tick.falloff, tick.cut);
    }
}

// The level of detail of this exponent: the one made before, or a new one, which replaces a level that no eye wants.
MergedMedia::Medium& MergedMedia::merged(std::span<const gpu::Particle> ordered, int exponent, float falloff) {
    for (const auto& medium : all_)
        if (medium->exponent == exponent) return *medium;
    const auto idle = std::find_if(all_.begin(), all_.end(), [](const auto& m) { return m->exponent == kNoLevel; });
    Medium& medium = idle != all_.end() ? **idle : *all_.emplace_back(std::make_unique<Medium>());
    medium.exponent = exponent;
    medium.list.clear();
    mergeCells(ordered, falloff, exponent, medium.list);
    medium.worth = medium.list.size() < ordered.size() / 4 * 3;
    medium.fresh = medium.worth;
    return medium;
}

VkDeviceSize MergedMedia::uploadBytes() const {
    VkDeviceSize bytes = 0;
    for (const Medium* medium : media_)
        if (medium->fresh) bytes += medium->list.size() * sizeof(gpu::Particle);
    return bytes;
}

void MergedMedia::write(const gpu::Device& device, const gpu::Buffer& through, VkDeviceSize at) {
    for (Medium* medium : media_) {
        if (!medium->fresh) continue;
        const VkDeviceSize bytes = medium->list.size() * sizeof(gpu::Particle);
        const VkDeviceSize room =
            medium->particles.size() < bytes ? bytes + bytes / 4 : bytes; // with a reserve, since lists grow a little
        medium->particles.atLeast(device, room, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                  gpu::Memory::device, "merged particles");
        std::copy(medium->list.begin(), medium->list.end(),
                  through.mapped<gpu::Particle>(medium->list.size(), at).begin());
        at += bytes;
    }
}

void MergedMedia::record(VkCommandBuffer cmd, const gpu::Buffer& through, VkDeviceSize at) const {
    for (const Medium* medium : media_) {
        if (!medium->fresh) continue;
        const VkBufferCopy copy{at, 0, medium->list.size() * sizeof(gpu::Particle)};
        vkCmdCopyBuffer(cmd, through.handle(), medium->particles.handle(), 1, &copy);
        at += copy.size;
    }
}

uint64_t MergedMedia::cpuBytes() const {
    uint64_t bytes = 0;
    for (const auto& medium : all_) bytes += medium->list.capacity() * sizeof(gpu::Particle);
    return bytes;
}

} // namespace brume
