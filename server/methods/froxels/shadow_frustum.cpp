#include "server/methods/froxels/shadow_frustum.h"

#include <algorithm>
#include <cstring>

#include "server/gpu/binding_sizes.h"
#include "server/inputs/constants.h"
#include "shaders/shadow_frustum_comp.h"

namespace brume {
namespace {

// Words of one eye's froxels, and of all. Eyes that would have more get fewer slices: behind them the grid is read.
constexpr uint32_t kMostOfEye = (2 << 20) / sizeof(uint32_t), kMostOfAll = gpu::kLargestBinding / sizeof(uint32_t);

} // namespace

ShadowFrusta::ShadowFrusta(const gpu::Device& device)
    : device_(device), rays_(device, 1, "frustum rays"), program_(device, shadow_frustum_comp, "shadow_frustum") {}

void ShadowFrusta::record(gpu::Commands& commands, const gpu::Resources& tick_resources, const TickInputs& shared,
                          const ShadowGrid& grid, std::span<const gpu::Eye> eyes,
                          std::span<const ShadowSlices> slices) {
    if (eyes.empty()) return;
    count_ = 0;
    const gpu::Commands::Pass pass(commands, "shadow frusta");
    wanted_.clear();
    uint32_t words = 0, most = 0; // words of all eyes, and of the eye that has most
    for (size_t i = 0; i < eyes.size(); ++i) {
        const ShadowSlices& own = slices[slices.size() > 1 ? i : 0];
        const uint32_t columns = gpu::groups(eyes[i].size.x, kPixels), rows = gpu::groups(eyes[i].size.y, kPixels),
                       padded = 4 * gpu::groups(columns, 4), slice_words = std::max(padded / 4 * rows, 1u),
                       count = std::min({own.count, kMostOfEye / slice_words, (kMostOfAll - words) / slice_words}),
                       own_words = slice_words * count;
        wanted_.push_back({eyes[i], words, padded, rows, count, kPixels, own.near, own.unit, own.growth});
        count_ += uint64_t(columns) * rows * count;
        words += own_words;
        most = std::max(most, own_words);
    }
    const bool same = grid_ == grid.version() && wanted_.size() == made_.size() &&
                      std::memcmp(wanted_.data(), made_.data(), wanted_.size() * sizeof(gpu::ShadowFrustum)) == 0;
    if (same) return;
    grid_ = grid.version(), made_ = wanted_;
    constexpr VkBufferUsageFlags kWritten = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    const VkDeviceSize bytes = made_.size() * sizeof(gpu::ShadowFrustum);
    frusta_.atLeast(device_, bytes, kWritten, gpu::Memory::device, "shadow frusta");
    froxels_.atLeast(device_, std::max<VkDeviceSize>(words * sizeof(uint32_t), 256),
                     kWritten | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::device, "shadow froxels");
    const VkCommandBuffer cmd = commands.handle();
    rays_.begin(commands);
    gpu::everythingBefore(cmd);                                    // readers of the call before
    constexpr size_t kAtOnce = 65536 / sizeof(gpu::ShadowFrustum); // frusta that one update can write
    for (size_t at = 0; at < made_.size(); at += kAtOnce)
        vkCmdUpdateBuffer(cmd, frusta_.handle(), at * sizeof(gpu::ShadowFrustum),
                          std::min(kAtOnce, made_.size() - at) * sizeof(gpu::ShadowFrustum), &made_[at]);
    gpu::everythingBefore(cmd);
    if (most > 0) {
        program_.with(constantsOf(shared.features))
            .bind(commands, tick_resources,
                  {gpu::uniformBuffer("GridBlock", grid.block(), 0, sizeof(gpu::ShadowGridBlock)),
                   gpu::storageBuffer("Frusta", frusta_), gpu::storageBuffer("Froxels", froxels_),
                   gpu::storageBuffer("Rays", rays_.buffer())});
        vkCmdDispatch(cmd, gpu::groups(most, 64), 1, uint32_t(made_.size()));
    }
    rays_.end(commands);
    gpu::everythingBefore(cmd);
}

} // namespace brume
