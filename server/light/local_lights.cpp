#include "server/light/local_lights.h"

#include <algorithm>

#include "shaders/local_light_bins_comp.h"
#include "shaders/local_light_comp.h"

namespace brume {
namespace {

uint32_t binsOf(uint32_t width, uint32_t height) {
    return gpu::groups(width, gpu::kLightBin) * gpu::groups(height, gpu::kLightBin);
}

} // namespace

LocalLights::LocalLights(const gpu::Device& device) : device_(device) { prepare({}, 0); }

void LocalLights::fit(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name) const {
    buffer.atLeast(device_, std::max<VkDeviceSize>(bytes, 256), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device,
                   name);
}

void LocalLights::prepare(std::span<const EyeRequest> eyes, uint32_t lights) {
    VkDeviceSize bits = 0, lit = 0;
    if (lights > 0)
        for (const EyeRequest& eye : eyes) {
            bits = std::max<VkDeviceSize>(bits, binsOf(eye.width, eye.height));
            lit = std::max<VkDeviceSize>(lit, VkDeviceSize(eye.width) * eye.height);
        }
    fit(bits_, bits * gpu::groups(lights, 32) * sizeof(uint32_t), "local light bins");
    fit(lit_, lit * sizeof(glm::vec3), "local light");
}

void LocalLights::giveBack() {
    bits_ = {}, lit_ = {};
    prepare({}, 0);
}

void LocalLights::recordBins(gpu::Commands& commands, const EyeInputs& in) {
    const gpu::Commands::Pass pass(commands, "local light bins", in.view);
    if (!bins_program_)
        bins_program_ = gpu::ComputeProgram(
            device_, {VK_SHADER_STAGE_COMPUTE_BIT, local_light_bins_comp, "local_light_bins"}, {});
    gpu::everythingBefore(commands.handle()); // the eye before has read its own
    bins_program_.bind(commands, {in.medium->tick, in.eye, gpu::storageBuffer(2, *in.shared->local_lights),
                                  gpu::storageBuffer(3, bits_)});
    vkCmdDispatch(commands.handle(), gpu::groups(binsOf(in.size.width, in.size.height), 64), 1, 1);
    gpu::everythingBefore(commands.handle());
}

void LocalLights::record(gpu::Commands& commands, const ViewGroup& group) {
    const EyeInputs& in = *group.any;
    const SceneFeatures& features = in.shared->features;
    const gpu::Commands::Pass pass(commands, "local light", group.view());
    gpu::ComputeProgram& program = programs_[{group.rate, group.colours, features}];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, local_light_comp, "local_light"},
                                      {{gpu::kIdHasOpaque, features.opaque},
                                       {gpu::kIdHasFog, features.fog},
                                       {gpu::kIdHasGlow, features.glow},
                                       {gpu::kIdHasLocalLights, true},
                                       {gpu::kIdRate, group.rate},
                                       {gpu::kIdSunColours, group.colours.sun},
                                       {gpu::kIdAmbientColours, group.colours.ambient}});
    gpu::computeToCompute(commands.handle());
    for (uint32_t i = 0; i < group.count(); ++i) {
        program.bind(commands,
                     {in.medium->tick, group.blockOf(i), gpu::storageBuffer(2, lit_),
                      gpu::storageBuffer(3, *in.shared->local_lights), gpu::storageBuffer(4, *group.field),
                      gpu::uniformBuffer(5, *in.shared->objects, 0, in.shared->objects->size()),
                      gpu::storageBuffer(6, bits_),
                      gpu::sampledImage(8, in.target->view_depth, *in.shared->nearest)});
        const gpu::View& view = group.views[i];
        vkCmdDispatch(commands.handle(), gpu::groups(view.eye.size.x, 8), gpu::groups(view.end - view.first, 8), 1);
    }
    gpu::computeToCompute(commands.handle());
}

} // namespace brume
