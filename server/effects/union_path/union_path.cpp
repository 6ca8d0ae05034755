#include "server/effects/union_path/union_path.h"

#include <algorithm>
#include <cstring>

#include "server/inputs/tick_block.h"
#include "server/inputs/union_block.h"
#include "shaders/shared/splat.h"
#include "shaders/union_bins_comp.h"
#include "shaders/union_path_comp.h"

namespace brume {
namespace {

constexpr VkDeviceSize kAligned = 256; // the largest alignment of offsets that a device may ask for
VkDeviceSize aligned(VkDeviceSize bytes) { return (bytes + kAligned - 1) / kAligned * kAligned; }
constexpr VkDeviceSize kBlockBytes = (sizeof(gpu::Tick) + kAligned - 1) / kAligned * kAligned;

} // namespace

UnionPath::UnionPath(const gpu::Device& device)
    : device_(device), bins_program_(device, union_bins_comp, "union_bins"),
      path_program_(device, union_path_comp, "union_path") {}

bool UnionPath::Key::operator==(const Key& o) const {
    return balls.radius == o.balls.radius && balls.sigma_t == o.balls.sigma_t && balls.cutoff == o.balls.cutoff &&
           objects == o.objects && groups == o.groups;
}

void UnionPath::prepare(const Simulation& simulation, const SceneNow& now, const gpu::Tick& tick, uint64_t particles,
                        uint64_t objects) {
    count_ = tick.particle_count;
    if (double(count_) > limits::kUnionCount.hi)
        throw gpu::Error("the union of balls: " + std::to_string(count_) + " particles, up to " +
                         std::to_string(int(limits::kUnionCount.hi)) + " are possible");
    const gpu::UnionBalls& balls = tick.balls;
    bits_.atLeast(device_, std::max(balls.side * balls.side * balls.words, 1u) * sizeof(uint32_t),
                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::device,
                  "cells of balls");
    const VkDeviceSize light_bytes = std::max(simulation.capacity(), 1u) * sizeof(gpu::ParticleLight);
    if (lights_ && lights_.size() < light_bytes) valid_ = false;
    lights_.atLeast(device_, light_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                    gpu::Memory::device, "light behind balls");

    const Past* past = simulation.past();
    // Blocks of past ticks have the extinction of all channels alone.
    const bool grey = extinctionParts(now.medium.extinction_colour) == glm::vec3(1);
    const Key key{balls, objects, past && grey ? now.render.path.groups : 1};
    now_ = simulation.tick();
    bins_ = !valid_ || particles != of_particles_ || tick.sun.to_light != to_light_ || !(key == key_);
    const bool all = !valid_ || !(key == key_) || (key.groups == 1 && bins_);
    key_ = key;
    of_particles_ = particles;
    to_light_ = tick.sun.to_light;
    valid_ = true;
    past_.clear();
    present_ = false;
    for (uint32_t group = 0; group < key.groups; ++group) {
        const uint64_t ago = (now_ % key.groups + key.groups - group) % key.groups;
        const uint64_t tick_of = ago == 0 ? now_ : past->at(now_ < ago ? 0 : now_ - ago).tick;
        if (!all && (key.groups == 1 || made_[group] == tick_of)) continue;
        made_[group] = tick_of;
        if (ago == 0)
            present_ = true;
        else
            past_.push_back({tick_of, group});
    }
    std::ranges::sort(past_, {}, &Update::tick);
    if (past_.empty()) return;
    const VkDeviceSize particle_bytes = aligned(count_ * sizeof(gpu::Particle));
    blocks_.atLeast(device_, past_.size() * kBlockBytes, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, gpu::Memory::upload,
                    "past ticks");
    particles_.atLeast(device_, past_.size() * particle_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload,
                       "past particles");
    for (size_t i = 0; i < past_.size(); ++i) {
        const PastTick& then = past->at(past_[i].tick);
        gpu::Tick block = tick;
        setSun(block, then.to_light);
        setBalls(block, now.medium, now.render, then.particles);
        blocks_.mapped<gpu::Tick>(1, i * kBlockBytes)[0] = block;
        std::ranges::copy(then.particles, particles_.mapped<gpu::Particle>(count_, i * particle_bytes).begin());
    }
    blocks_.flush();
    particles_.flush();
}

void UnionPath::record(gpu::Commands& commands, const MediumView& all) {
    const VkCommandBuffer cmd = commands.handle();
    if (count_ == 0 || !(bins_ || present_ || !past_.empty())) return;
    const gpu::Commands::Pass pass(commands, "union path");
    gpu::everythingBefore(cmd); // the last tick's viewers have read it
    const VkDeviceSize particle_bytes = aligned(count_ * sizeof(gpu::Particle));
    for (size_t i = 0; i < past_.size(); ++i) {
        gpu::Resources then(&all.resources);
        then.give(gpu::uniformBuffer("TickBlock", blocks_, i * kBlockBytes, sizeof(gpu::Tick)));
        then.give(gpu::storageBuffer("Particles", particles_, i * particle_bytes, particle_bytes));
        recordBins(commands, then);
        recordGroup(commands, then, past_[i].group);
    }
    recordBins(commands, all.resources);
    if (present_) recordGroup(commands, all.resources, uint32_t(now_ % key_.groups));
    gpu::everythingBefore(cmd);
}

void UnionPath::recordBins(gpu::Commands& commands, const gpu::Resources& tick) {
    const VkCommandBuffer cmd = commands.handle();
    gpu::everythingBefore(cmd); // the group before has read them
    vkCmdFillBuffer(cmd, bits_.handle(), 0, VK_WHOLE_SIZE, 0);
    gpu::transferToCompute(cmd);
    bins_program_.with().bind(commands, tick, {gpu::storageBuffer("UnionBits", bits_)});
    vkCmdDispatch(cmd, gpu::groups(count_, 64), 1, 1);
    gpu::computeToCompute(cmd);
}

void UnionPath::recordGroup(gpu::Commands& commands, const gpu::Resources& tick, uint32_t group) {
    const uint32_t push[] = {group, key_.groups};
    path_program_.with().bind(
        commands, tick, {gpu::storageBuffer("ParticleLights", lights_), gpu::storageBuffer("UnionBits", bits_)}, push);
    vkCmdDispatch(commands.handle(), gpu::groups(gpu::groups(count_, key_.groups), 64), 1, 1);
    gpu::computeToCompute(commands.handle());
}

} // namespace brume
