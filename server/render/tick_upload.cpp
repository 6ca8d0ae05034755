#include "server/render/tick_upload.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "server/gpu/commands.h"
#include "server/inputs/tick_block.h"

namespace brume {
namespace {

bool sameBits(std::span<const gpu::Particle> a, std::span<const gpu::Particle> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

} // namespace

TickUpload::TickUpload(const gpu::Device& device, uint32_t capacity)
    : device_(device), capacity_(capacity),
      particles_(device, std::max(capacity, 1u) * sizeof(gpu::Particle),
                 VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::device,
                 "particles") {}

void TickUpload::take(const Simulation& simulation, const Scene& scene, const SceneNow& now,
                      std::span<const gpu::Opaque> objects, std::span<const EyeRequest> eyes, gpu::Buffer& staging) {
    now_.resize(simulation.liveCount());
    simulation.write(now_);
    moved_ = !sameBits(now_, then_);
    const gpu::Tick before = tick_;
    ballsOf(now_, simulation.axes(), balls_);
    tick_ = makeTick(scene, now, now_, objects, balls_);
    if (std::exchange(forgotten_, false) || moved_ || tick_.falloff != before.falloff || tick_.cut != before.cut) {
        ++version_;
        extent_ = mediumExtent(now_, tick_.falloff, tick_.cut, now.medium.model == kTetrahedraMedium);
        if (!balls_.empty()) extent_.deviation = mediumExtent(balls_, tick_.falloff, tick_.cut).deviation;
    }
    std::span<const gpu::Particle> ordered = now_;
    // Tetrahedra know their corners by number, as axes know their particles.
    const bool numbered = now.medium.model != kSumMedium && now.medium.model != kUnionMedium;
    if (now_.size() >= kLargeMedium && !numbered) {
        ordered_.resize(now_.size());
        if (moved_) order_.sort(now_, ordered_);
        ordered = ordered_;
    }
    const std::span<const gpu::EllipsoidAxes> axes = simulation.axes();
    levels_.choose(ordered, moved_, tick_, extent_, eyes, numbered ? 0 : now.render.merge); // levels are of balls
    axes_wait_ = !axes.empty() && !axes_there_;
    const VkDeviceSize bytes = capacity_ * sizeof(gpu::Particle), more = axes_wait_ ? axes.size_bytes() : 0;
    staging.atLeast(device_, std::max<VkDeviceSize>(bytes + levels_.uploadBytes() + more, 256),
                    VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::upload, "particle upload");
    if (moved_) std::copy(ordered.begin(), ordered.end(), staging.mapped<gpu::Particle>(ordered.size()).begin());
    levels_.write(device_, staging, bytes);
    if (axes_wait_) {
        axes_.atLeast(device_, more, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                      gpu::Memory::device, "semi-axes");
        std::ranges::copy(axes, staging.mapped<gpu::EllipsoidAxes>(axes.size(), bytes).begin());
    }
    staging.flush();
}

void TickUpload::writeBlocks(const UniformBlocks& blocks, std::span<const Hue> hues, const gpu::Resources& shared) {
    for (uint32_t hue = 0; hue < hues.size(); ++hue) {
        blocks.setTick(hue, hues[hue].of(tick_));
        uint32_t level = 0;
        for (const MergedMedia::Medium* medium : levels_.media())
            blocks.setLevel(hue, level++, hues[hue].of(medium->tick));
    }
    // A list is what merging by cells of this size makes of the particles.
    const auto viewOf = [&](const gpu::Buffer& particles, uint32_t count, const MediumExtent& extent, int exponent) {
        MediumView view{gpu::Resources(&shared), count, version_ << 16 | uint16_t(exponent), &extent};
        const gpu::Resource list = gpu::storageBuffer("Particles", particles);
        view.resources.give(list);
        view.resources.give(list.as("ParticleLights")); // until they are lit it is not read
        view.resources.give(axes_ ? gpu::storageBuffer("Axes", axes_) : list.as("Axes"));
        return view;
    };
    all_ = viewOf(particles_, tick_.particle_count, extent_, kNoLevel);
    for (MergedMedia::Medium* medium : levels_.media())
        medium->view = viewOf(medium->particles, medium->tick.particle_count, medium->extent, medium->exponent);
    enter(blocks, 0);
}

void TickUpload::enter(const UniformBlocks& blocks, uint32_t hue) {
    all_.resources.give(blocks.tick(hue));
    uint32_t level = 0;
    for (MergedMedia::Medium* medium : levels_.media()) medium->view.resources.give(blocks.level(hue, level++));
}

const MediumView& TickUpload::of(size_t eye) const {
    const MergedMedia::Medium* level = levels_.of(eye);
    return level ? level->view : all_;
}

std::span<MediumView* const> TickUpload::seenBy(size_t eyes) {
    seen_.clear();
    for (size_t eye = 0; eye < eyes && seen_.empty(); ++eye)
        if (!levels_.of(eye)) seen_.push_back(&all_);
    for (MergedMedia::Medium* medium : levels_.media()) seen_.push_back(&medium->view);
    return seen_;
}

void TickUpload::record(gpu::Commands& commands, const gpu::Buffer& staging) const {
    if ((!moved_ && !axes_wait_ && levels_.uploadBytes() == 0) || tick_.particle_count == 0) return;
    const gpu::Commands::Pass pass(commands, "upload");
    const VkCommandBuffer cmd = commands.handle();
    gpu::everythingBefore(cmd);
    const VkBufferCopy copy{0, 0, tick_.particle_count * sizeof(gpu::Particle)};
    if (moved_) vkCmdCopyBuffer(cmd, staging.handle(), particles_.handle(), 1, &copy);
    if (axes_wait_) {
        const VkBufferCopy to_axes{capacity_ * sizeof(gpu::Particle), 0, axes_.size()};
        vkCmdCopyBuffer(cmd, staging.handle(), axes_.handle(), 1, &to_axes);
    }
    levels_.record(cmd, staging, capacity_ * sizeof(gpu::Particle));
    gpu::transferToCompute(cmd);
}

uint64_t TickUpload::cpuBytes() const {
    return (now_.capacity() + then_.capacity() + ordered_.capacity() + balls_.capacity()) * sizeof(gpu::Particle) +
           order_.bytes() + levels_.cpuBytes();
}

} // namespace brume
