#include "server/render/compose.h"

#include <algorithm>

#include "shaders/compose_comp.h"
#include "shaders/present_comp.h"
#include "shaders/shade_comp.h"
#include "shaders/shade_drawn_comp.h"

namespace brume {

Compose::Compose(const gpu::Device& device)
    : device_(device), show_(device),
      none_(device, 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "no field") {}

void Compose::prepare(std::span<const ViewGroup> groups, std::span<const EyeRequest> eyes) {
    show_.prepare(eyes, full_);
    VkDeviceSize words = 0;
    for (const ViewGroup& group : groups)
        for (const gpu::View& view : group.views)
            words = std::max<VkDeviceSize>(words, view.shaded + shadedWords(view, group.step));
    shaded_.atLeast(device_, words * sizeof(uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device,
                    "shaded nodes");
}

// Blocks of 8x2 pixels that a lane of compose.comp makes: whole cells of the field, so that its pixels share their
// look-ups.
uint32_t Compose::blocksOf(const SceneFeatures& features, uint32_t rate) {
    return features.opaque && (rate == 3 || rate == 6 || rate == 12) ? 3 : 1;
}

const gpu::ComputeProgram& Compose::everyPixel(const Variant& v) {
    gpu::ComputeProgram& program = every_pixel_[v];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, compose_comp, "compose"},
                                      {{gpu::kIdHasOpaque, v.features.opaque},
                                       {gpu::kIdHasCasters, v.features.casters},
                                       {gpu::kIdHasLobe, v.features.lobe},
                                       {gpu::kIdHasAmbient, v.features.ambient},
                                       {gpu::kIdHasFog, v.features.fog},
                                       {gpu::kIdHasGlow, v.features.glow},
                                       {gpu::kIdHasLocalLights, v.features.local_lights},
                                       {gpu::kIdRate, v.rate},
                                       {gpu::kIdSunColours, v.colours.sun},
                                       {gpu::kIdAmbientColours, v.colours.ambient},
                                       {gpu::kIdMultipleColours, v.colours.multiple},
                                       {gpu::kIdScattering, v.colours.model},
                                       {gpu::kIdDrawn, v.drawn},
                                       {gpu::kIdKeep, v.keep},
                                       {gpu::kIdFull, v.full},
                                       {gpu::kIdHasGlass, v.features.glass},
                                       {gpu::kIdBlocks, v.drawn ? 1 : blocksOf(v.features, v.rate)}});
    return program;
}

const gpu::ComputeProgram& Compose::someNodes(const Variant& v) {
    gpu::ComputeProgram& program = some_nodes_[v];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, shade_comp, "shade"},
                                      {{gpu::kIdHasLobe, v.features.lobe},
                                       {gpu::kIdHasAmbient, v.features.ambient},
                                       {gpu::kIdStep, v.step},
                                       {gpu::kIdRate, v.rate},
                                       {gpu::kIdSunColours, v.colours.sun},
                                       {gpu::kIdAmbientColours, v.colours.ambient},
                                       {gpu::kIdMultipleColours, v.colours.multiple},
                                       {gpu::kIdScattering, v.colours.model}});
    return program;
}

void Compose::record(gpu::Commands& commands, const ViewGroup& group) {
    if (group.step == 1) {
        recordEveryPixel(commands, group);
    } else {
        group.field ? shadeField(commands, group) : shadeTarget(commands, group);
        present(commands, group);
    }
    show_.record(commands, group);
}

void Compose::recordEveryPixel(gpu::Commands& commands, const ViewGroup& group) {
    const gpu::Commands::Pass pass(commands, "compose", group.view());
    const VkCommandBuffer cmd = commands.handle();
    const EyeInputs& in = *group.any;
    const bool drawn = !group.field;
    SceneFeatures features = in.shared->features;
    if (drawn) features.lobe = features.fog = features.glow = features.local_lights = features.glass = false;
    gpu::computeToCompute(cmd);
    const gpu::ComputeProgram& program =
        everyPixel({.drawn = drawn,
                    .keep = !drawn && (keep_ || features.glass),
                    .full = full_,
                    .rate = drawn ? 8 : group.rate,
                    .step = 1,
                    .colours = drawn ? gpu::FieldColours{1, 0, 0, 0, 0} : group.colours,
                    .features = features});
    const uint32_t blocks = drawn ? 1 : blocksOf(features, group.rate);
    for (uint32_t i = 0; i < group.count(); ++i) {
        program.bind(commands, group.resources,
                     {group.blockOf(i), gpu::storageBuffer("Field", drawn ? none_ : *group.field)});
        const gpu::View& view = group.views[i];
        vkCmdDispatch(cmd, gpu::groups(view.eye.size.x, 64 * blocks), gpu::groups(view.end - view.first, 16), 1);
    }
}

void Compose::shadeField(gpu::Commands& commands, const ViewGroup& group) {
    const gpu::Commands::Pass pass(commands, "shade", group.view());
    const VkCommandBuffer cmd = commands.handle();
    const EyeInputs& in = *group.any;
    const uint32_t width = group.most([](const gpu::View& v) { return v.eye.size.x; });
    const uint32_t rows = group.most([](const gpu::View& v) { return v.end - v.first; });
    gpu::computeToCompute(cmd);
    someNodes({.drawn = false,
               .keep = false,
               .full = false,
               .rate = group.rate,
               .step = group.step,
               .colours = group.colours,
               .features = in.shared->features})
        .bind(commands, group.resources, {gpu::storageBuffer("Shaded", shaded_)});
    vkCmdDispatch(cmd, gpu::groups(gpu::groups(width, group.step) + 3, 8),
                  gpu::groups(gpu::groups(rows, group.step) + 3, 8), group.count());
    gpu::computeToCompute(cmd);
}

void Compose::shadeTarget(gpu::Commands& commands, const ViewGroup& group) {
    const gpu::Commands::Pass pass(commands, "shade", group.view());
    const VkCommandBuffer cmd = commands.handle();
    const EyeInputs& in = *group.any;
    gpu::computeToCompute(cmd);
    gpu::ComputeProgram& program = drawn_nodes_[group.step];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, shade_drawn_comp, "shade_drawn"},
                                      {{gpu::kIdStep, group.step}});
    program.bind(commands, group.resources, {gpu::storageBuffer("Shaded", shaded_)});
    vkCmdDispatch(cmd, gpu::groups(in.size.width, 8), gpu::groups(in.size.height, 8), 1);
    gpu::computeToCompute(cmd);
}

void Compose::present(gpu::Commands& commands, const ViewGroup& group) {
    const gpu::Commands::Pass pass(commands, "present", group.view());
    const VkCommandBuffer cmd = commands.handle();
    gpu::ComputeProgram& program = present_[{group.step, full_}];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, present_comp, "present"},
                                      {{gpu::kIdStep, group.step}, {gpu::kIdFull, full_}});
    program.bind(commands, group.resources, {gpu::storageBuffer("Shaded", shaded_)});
    const uint32_t width = group.most([](const gpu::View& v) { return v.eye.size.x; });
    const uint32_t rows = group.most([](const gpu::View& v) { return v.end - v.first; });
    vkCmdDispatch(cmd, gpu::groups(width, 128), gpu::groups(rows, 32), group.count());
}

} // namespace brume
