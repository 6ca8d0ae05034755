#include "server/render/glass_layers.h"

#include <algorithm>

#include "server/inputs/glass_block.h"
#include "shaders/glass_comp.h"

namespace brume {

GlassLayers::GlassLayers(const gpu::Device& device, std::span<const Glass> glasses)
    : device_(device), glasses_(glasses.begin(), glasses.end()), program_(device, glass_comp, "glass") {
    if (glasses_.empty()) return;
    sheets_ = gpu::Buffer(device, glasses_.size() * sizeof(gpu::GlassSheet), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                          gpu::Memory::upload, "glass");
    std::ranges::transform(glasses_, sheets_.mapped<gpu::GlassSheet>(glasses_.size()).begin(), glassSheet);
    sheets_.flush();
}

void GlassLayers::prepare(std::span<const EyeRequest> eyes) {
    VkDeviceSize pixels = 0;
    for (const EyeRequest& eye : eyes) pixels = std::max(pixels, VkDeviceSize(eye.width) * eye.height);
    if (pixels == 0) return;
    sums_.atLeast(device_, pixels * kBytesOfPixel, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device,
                  "sums of layers");
}

uint32_t GlassLayers::layersOf(const EyeInputs& in) const {
    return glassLayers(glasses_, in.pose, frustumOf(in.pose, in.size.width, in.size.height));
}

void GlassLayers::record(gpu::Commands& commands, const ViewGroup& group, uint32_t drawn, uint32_t layers) {
    const EyeInputs& in = *group.any;
    const gpu::Commands::Pass pass(commands, "glass", in.view);
    const gpu::View& view = group.views.front();
    const gpu::GlassPush push{uint32_t(glasses_.size()), drawn, layers, view.first, view.end};
    gpu::everythingBefore(commands.handle());
    program_.with().bind(commands, in.resources,
                         {gpu::storageBuffer("Sheets", sheets_), gpu::storageBuffer("Sums", sums_)}, push);
    vkCmdDispatch(commands.handle(), gpu::groups(in.size.width, 8), gpu::groups(push.end - push.first, 8), 1);
    gpu::everythingBefore(commands.handle());
}

} // namespace brume
