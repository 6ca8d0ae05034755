#include "server/light/local_lights.h"

#include <algorithm>
#include <cstring>

#include "server/inputs/constants.h"
#include "server/medium/band_limit.h"
#include "shaders/local_light_bins_comp.h"
#include "shaders/local_light_comp.h"
#include "shaders/local_light_depth_comp.h"

namespace brume {
namespace {

bool sameBits(std::span<const gpu::LocalLight> a, std::span<const gpu::LocalLight> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

uint32_t binsOf(uint32_t width, uint32_t height) {
    return gpu::groups(width, gpu::kPixelTile) * gpu::groups(height, gpu::kPixelTile);
}

} // namespace

LocalLights::LocalLights(const gpu::Device& device)
    : device_(device), depths_program_(device, local_light_depth_comp, "local_light_depth"),
      bins_program_(device, local_light_bins_comp, "local_light_bins"),
      program_(device, local_light_comp, "local_light") {
    prepare({}, 0, 0);
}

void LocalLights::fit(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name) const {
    buffer.atLeast(device_, std::max<VkDeviceSize>(bytes, gpu::kLeastBinding), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                   gpu::Memory::device, name);
}

void LocalLights::prepare(std::span<const EyeRequest> eyes, uint32_t lights, uint32_t volumes) {
    VkDeviceSize bits = 0, lit = 0;
    for (const EyeRequest& eye : eyes) {
        bits = std::max<VkDeviceSize>(bits, binsOf(eye.width, eye.height));
        lit = std::max<VkDeviceSize>(lit, VkDeviceSize(eye.width) * eye.height);
    }
    fit(bits_, bits * gpu::groups(lights, 32) * sizeof(uint32_t), "local light bins");
    fit(lit_, lit * sizeof(glm::vec3), "local light");
    const VkDeviceSize before = depths_.size();
    fit(depths_, volumes * sizeof(float), "local light depths");
    if (depths_.size() != before) last_lights_.clear();
}

void LocalLights::giveBack() {
    bits_ = {}, depths_ = {}, lit_ = {};
    prepare({}, 0, 0);
}

void LocalLights::recordDepths(gpu::Commands& commands, const MediumView& medium,
                               std::span<const gpu::LocalLight> lights) {
    const auto has_volume = [](const gpu::LocalLight& light) { return light.volume != gpu::kNoVolume; };
    if (std::ranges::none_of(lights, has_volume)) return;
    if (last_medium_ == medium.version && sameBits(lights, last_lights_)) return;
    last_medium_ = medium.version;
    last_lights_.assign(lights.begin(), lights.end());
    const gpu::Commands::Pass pass(commands, "local light depth");
    gpu::everythingBefore(commands.handle());
    depths_program_.with().bind(commands, medium.resources, {gpu::storageBuffer("LightDepths", depths_)});
    vkCmdDispatch(commands.handle(), gpu::kMostLightSide / 8, gpu::kMostLightSide / 8, uint32_t(lights.size()));
    gpu::everythingBefore(commands.handle());
}

void LocalLights::recordBins(gpu::Commands& commands, const EyeInputs& in) {
    const gpu::Commands::Pass pass(commands, "local light bins", in.view);
    gpu::everythingBefore(commands.handle()); // the eye before has read its own
    bins_program_.with().bind(commands, in.resources, {gpu::storageBuffer("LightBits", bits_)});
    vkCmdDispatch(commands.handle(), gpu::groups(binsOf(in.size.width, in.size.height), 64), 1, 1);
    gpu::everythingBefore(commands.handle());
}

void LocalLights::record(gpu::Commands& commands, const ViewGroup& group) {
    const EyeInputs& in = *group.any;
    const gpu::Commands::Pass pass(commands, "local light", group.view());
    const uint32_t step = pixelStep(in.shared->settings->shading, group.rate, in.medium->count > 0);
    const gpu::Program& program = program_.with(constantsOf(group), {{gpu::kIdStep, step}});
    gpu::computeToCompute(commands.handle());
    for (uint32_t i = 0; i < group.count(); ++i) {
        program.bind(commands, group.resources, {group.blockOf(i), gpu::storageBuffer("LitByLocalLights", lit_)});
        const gpu::View& view = group.views[i];
        vkCmdDispatch(commands.handle(), gpu::groups(view.eye.size.x, gpu::kPixelTile),
                      gpu::groups(view.end - view.first, gpu::kPixelTile), 1);
    }
    gpu::computeToCompute(commands.handle());
}

} // namespace brume
