#include "server/render/compose.h"

#include <algorithm>

#include "server/inputs/constants.h"
#include "shaders/compose_comp.h"
#include "shaders/present_comp.h"
#include "shaders/shade_comp.h"
#include "shaders/shade_drawn_comp.h"

namespace brume {

Compose::Compose(const gpu::Device& device)
    : device_(device), show_(device),
      none_(device, 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "no field"),
      every_pixel_(device, compose_comp, "compose"), some_nodes_(device, shade_comp, "shade"),
      drawn_nodes_(device, shade_drawn_comp, "shade_drawn"), present_(device, present_comp, "present") {}

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
    if (drawn) {
        features.lobe = features.fog = features.glow = features.emission = false;
        features.local_lights = features.glass = false;
    }
    gpu::computeToCompute(cmd);
    const uint32_t rate = drawn ? 8 : group.rate, blocks = drawn ? 1 : blocksOf(features, rate);
    const gpu::Program& program =
        every_pixel_.with(constantsOf(features, drawn ? gpu::FieldColours{1, 0, 0, 0, 0} : group.colours, rate),
                          {{gpu::kIdDrawn, drawn},
                           {gpu::kIdKeep, !drawn && (keep_ || features.glass)},
                           {gpu::kIdFull, full_},
                           {gpu::kIdBlocks, blocks}});
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
    const uint32_t width = group.most([](const gpu::View& v) { return v.eye.size.x; });
    const uint32_t rows = group.most([](const gpu::View& v) { return v.end - v.first; });
    gpu::computeToCompute(cmd);
    some_nodes_.with(constantsOf(group), {{gpu::kIdStep, group.step}})
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
    drawn_nodes_.with({{gpu::kIdStep, group.step}})
        .bind(commands, group.resources, {gpu::storageBuffer("Shaded", shaded_)});
    vkCmdDispatch(cmd, gpu::groups(in.size.width, 8), gpu::groups(in.size.height, 8), 1);
    gpu::computeToCompute(cmd);
}

void Compose::present(gpu::Commands& commands, const ViewGroup& group) {
    const gpu::Commands::Pass pass(commands, "present", group.view());
    const VkCommandBuffer cmd = commands.handle();
    present_.with({{gpu::kIdStep, group.step}, {gpu::kIdFull, full_}})
        .bind(commands, group.resources, {gpu::storageBuffer("Shaded", shaded_)});
    const uint32_t width = group.most([](const gpu::View& v) { return v.eye.size.x; });
    const uint32_t rows = group.most([](const gpu::View& v) { return v.end - v.first; });
    vkCmdDispatch(cmd, gpu::groups(width, 128), gpu::groups(rows, 32), group.count());
}

} // namespace brume
