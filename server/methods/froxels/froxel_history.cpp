#include "server/methods/froxels/froxel_history.h"

#include "server/gpu/binding_sizes.h"

namespace brume {
namespace {

constexpr uint64_t kKept = 120;            // submissions without a picture of an eye, after which it is forgotten
constexpr uint64_t kHues = 4;              // numbers for each eye: each hue has a history of its own
constexpr uint64_t kMostBytes = 512 << 20; // of all eyes
constexpr VkBufferUsageFlags kBlock = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

} // namespace

FroxelHistory::FroxelHistory(const gpu::Device& device)
    : device_(device),
      nobodys_cells_(device, 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "no history"),
      nobodys_block_(device, sizeof(gpu::HistoryBlock), kBlock, gpu::Memory::device, "no history") {}

FroxelHistory::Bound FroxelHistory::record(gpu::Commands& commands, const EyeInputs& in, const gpu::FroxelGrid& froxels,
                                           bool whole) {
    const Bound none{false, &nobodys_cells_, &nobodys_block_};
    const float part = in.shared->settings->froxels.history;
    if (part == 0) eyes_.clear(); // what was long ago is not blended in when it is switched on again
    const uint32_t cells = froxels.rays.x * froxels.rays.y * froxels.slices;
    const uint64_t bytes = 2 * uint64_t(cells) * sizeof(glm::vec4);
    if (part == 0 || in.history == 0 || !whole || bytes > gpu::kLargestBinding) return none;
    const uint64_t number = kHues * in.history + in.shared->hue;
    const auto known = eyes_.find(number);
    uint64_t others = 0;
    for (const auto& [other, eye] : eyes_)
        if (other != number) others += eye.cells.size();
    if (others + bytes > kMostBytes) {
        if (known != eyes_.end()) eyes_.erase(known);
        return none;
    }
    Eye& own = eyes_[number];
    if (own.froxels.rays != froxels.rays || own.froxels.slices != froxels.slices) {
        own = {};
        own.cells =
            gpu::Buffer(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "cells of a viewer");
        own.block = gpu::Buffer(device_, sizeof(gpu::HistoryBlock), kBlock, gpu::Memory::device, "history of a viewer");
    }
    const gpu::HistoryBlock block{.eye = own.eye,
                                  .froxels = own.froxels,
                                  .first = own.second ? cells : 0,
                                  .own = own.second ? 0 : cells,
                                  .known = own.known,
                                  .part = part};
    vkCmdUpdateBuffer(commands.handle(), own.block.handle(), 0, sizeof block, &block);
    gpu::everythingBefore(commands.handle());
    own.eye = in.block->eye, own.froxels = froxels;
    own.second = !own.second, own.known = true, own.seen = submission_;
    return {true, &own.cells, &own.block};
}

void FroxelHistory::forgetOld() {
    ++submission_;
    std::erase_if(eyes_, [&](const auto& eye) { return eye.second.seen + kKept < submission_; });
}

} // namespace brume
