#include "server/opaque/shafts.h"

#include <algorithm>

#include "common/scene_limits.h"
#include "server/inputs/constants.h"
#include "server/medium/band_limit.h"
#include "shaders/shafts_comp.h"

namespace brume {
namespace {

static_assert(limits::kObjects.hi == gpu::kMostBodies);

} // namespace

Shafts::Shafts(const gpu::Device& device) : device_(device), program_(device, shafts_comp, "shafts") { prepare({}); }

void Shafts::prepare(std::span<const EyeRequest> eyes) {
    VkDeviceSize pixels = 0;
    for (const EyeRequest& eye : eyes) pixels = std::max<VkDeviceSize>(pixels, VkDeviceSize(eye.width) * eye.height);
    sunlit_.atLeast(device_, std::max<VkDeviceSize>(pixels * kBytesOfPixel, gpu::kLeastBinding),
                    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "shafts");
}

void Shafts::giveBack() {
    sunlit_ = {};
    prepare({});
}

void Shafts::record(gpu::Commands& commands, const ViewGroup& group) {
    const EyeInputs& in = *group.any;
    const gpu::Commands::Pass pass(commands, "shafts", group.view());
    const uint32_t step = pixelStep(in.shared->settings->shading, group.rate, in.medium->count > 0);
    const gpu::Program& program = program_.with(constantsOf(group), {{gpu::kIdStep, step}});
    gpu::computeToCompute(commands.handle());
    for (uint32_t i = 0; i < group.count(); ++i) {
        program.bind(commands, group.resources, {group.blockOf(i), gpu::storageBuffer("Sunlit", sunlit_)});
        const gpu::View& view = group.views[i];
        vkCmdDispatch(commands.handle(), gpu::groups(view.eye.size.x, gpu::kPixelTile),
                      gpu::groups(view.end, gpu::kPixelTile) - view.first / gpu::kPixelTile, 1);
    }
    gpu::computeToCompute(commands.handle());
}

} // namespace brume
