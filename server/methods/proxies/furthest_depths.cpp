#include "server/methods/proxies/furthest_depths.h"

#include "shaders/furthest_depths_comp.h"

namespace brume {
namespace {

VkExtent2D tilesOf(const EyeInputs& in) {
    return {gpu::groups(in.size.width, gpu::kPixelTile), gpu::groups(in.size.height, gpu::kPixelTile)};
}

} // namespace

FurthestDepths::FurthestDepths(const gpu::Device& device)
    : device_(device), program_(device, {VK_SHADER_STAGE_COMPUTE_BIT, furthest_depths_comp, "furthest_depths"}) {}

void FurthestDepths::prepare(std::span<const EyeInputs> eyes) {
    for (const EyeInputs& in : eyes) {
        const VkExtent2D tiles = tilesOf(in);
        buffer_.atLeast(device_, VkDeviceSize(tiles.width) * tiles.height * sizeof(float),
                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "furthest depths");
    }
}

void FurthestDepths::record(gpu::Commands& commands, const EyeInputs& in) const {
    const VkExtent2D tiles = tilesOf(in);
    program_.bind(commands, in.resources, {gpu::storageBuffer("Furthest", buffer_)});
    vkCmdDispatch(commands.handle(), tiles.width, tiles.height, 1);
    gpu::computeToCompute(commands.handle());
}

} // namespace brume
