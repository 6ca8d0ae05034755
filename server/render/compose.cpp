#include "server/render/compose.h"

#include <cmath>
#include <limits>

#include "server/render/shading.h"
#include "shaders/compose_comp.h"
#include "shaders/present_comp.h"
#include "shaders/shade_comp.h"
#include "shaders/shade_drawn_comp.h"

namespace brume {

Compose::Compose(const gpu::Device& device, const SceneFeatures& features)
    : device_(device), features_(features),
      none_(device, 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "no field") {}

uint32_t Compose::stepOf(const EyeInputs& in, uint32_t rate, float deviation) const {
    if (features_.opaque || keep_) return 1;
    const float pixel = 2 * in.block->eye.tan_y / float(in.size.height); // rad
    const float lobe = in.lobe ? (1 - std::abs(in.asymmetry)) / pixel : std::numeric_limits<float>::infinity();
    return shadingStep(*in.settings, rate, deviation, lobe);
}

uint32_t Compose::shadedWords(const gpu::View& view, uint32_t step) { // lib/shaded.glsl
    return step == 1 ? 0 : 2 * (gpu::groups(view.eye.size.x, step) + 3) * (gpu::groups(view.end - view.first, step) + 3);
}

void Compose::fit(VkDeviceSize shaded_words) {
    const VkDeviceSize bytes = shaded_words * sizeof(uint32_t);
    if (bytes > 0 && (!shaded_ || shaded_.size() < bytes))
        shaded_ = gpu::Buffer(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "shaded nodes");
}

// Of 8x2 pixels, that a lane of compose.comp makes: whole cells of the field, so that its pixels share what they look up.
uint32_t Compose::blocksOf(uint32_t rate) const { return features_.opaque && (rate == 3 || rate == 6 || rate == 12) ? 3 : 1; }

const gpu::ComputeProgram& Compose::everyPixel(const Variant& v) {
    gpu::ComputeProgram& program = every_pixel_[v];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, compose_comp, "compose"},
                                      {{gpu::kIdHasOpaque, features_.opaque},
                                       {gpu::kIdHasCasters, features_.casters},
                                       {gpu::kIdHasLobe, v.lobe},
                                       {gpu::kIdHasAmbient, features_.ambient},
                                       {gpu::kIdRate, v.rate},
                                       {gpu::kIdSources, v.sources},
                                       {gpu::kIdDrawn, v.drawn},
                                       {gpu::kIdKeep, v.keep},
                                       {gpu::kIdFull, v.full},
                                       {gpu::kIdBlocks, v.drawn ? 1 : blocksOf(v.rate)}});
    return program;
}

const gpu::ComputeProgram& Compose::someNodes(const Variant& v) {
    gpu::ComputeProgram& program = some_nodes_[v];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, shade_comp, "shade"},
                                      {{gpu::kIdHasLobe, v.lobe},
                                       {gpu::kIdHasAmbient, features_.ambient},
                                       {gpu::kIdStep, v.step},
                                       {gpu::kIdRate, v.rate},
                                       {gpu::kIdSources, v.sources}});
    return program;
}

void Compose::record(gpu::Commands& commands, const EyeInputs& in) {
    if (in.step > 1) return recordDrawnNodes(commands, in);
    const gpu::Commands::Pass pass(commands, "compose", in.view);
    const VkCommandBuffer cmd = commands.handle();
    gpu::computeToCompute(cmd);
    everyPixel({.drawn = true, .keep = false, .lobe = false, .full = full_, .rate = 8, .sources = 1, .step = 1})
        .bind(commands, {in.tick, in.view_block, gpu::storageImage(2, *in.radiance), gpu::storageBuffer(3, *in.planes),
                         gpu::storageBuffer(4, none_), gpu::uniformBuffer(5, *in.objects, 0, in.objects->size()),
                         gpu::sampledImage(8, *in.view_depth, *in.nearest)});
    vkCmdDispatch(cmd, gpu::groups(in.size.width, 64), gpu::groups(in.size.height, 16), 1);
}

void Compose::record(gpu::Commands& commands, const ViewGroup& group, const gpu::Buffer& field) {
    if (group.step > 1) return recordShaded(commands, group, field);
    const gpu::Commands::Pass pass(commands, "compose", group.view());
    const VkCommandBuffer cmd = commands.handle();
    const EyeInputs& in = *group.any;
    gpu::computeToCompute(cmd);
    const gpu::ComputeProgram& program = everyPixel(
        {.drawn = false, .keep = keep_, .lobe = in.lobe, .full = full_, .rate = group.rate, .sources = group.sources, .step = 1});
    for (uint32_t i = 0; i < group.count(); ++i) {
        program.bind(commands, {in.tick, group.blockOf(i), gpu::storageImage(2, *in.radiance), gpu::storageBuffer(3, *in.planes),
                                gpu::storageBuffer(4, field), gpu::uniformBuffer(5, *in.objects, 0, in.objects->size()),
                                gpu::sampledImage(8, *in.view_depth, *in.nearest)});
        const gpu::View& view = group.views[i];
        vkCmdDispatch(cmd, gpu::groups(view.eye.size.x, 64 * blocksOf(group.rate)), gpu::groups(view.end - view.first, 16), 1);
    }
}

void Compose::recordShaded(gpu::Commands& commands, const ViewGroup& group, const gpu::Buffer& field) {
    const VkCommandBuffer cmd = commands.handle();
    const EyeInputs& in = *group.any;
    const uint32_t width = group.most([](const gpu::View& v) { return v.eye.size.x; });
    const uint32_t rows = group.most([](const gpu::View& v) { return v.end - v.first; });
    {
        const gpu::Commands::Pass pass(commands, "shade", group.view());
        gpu::computeToCompute(cmd);
        someNodes({.drawn = false,
                   .keep = false,
                   .lobe = in.lobe,
                   .full = false,
                   .rate = group.rate,
                   .sources = group.sources,
                   .step = group.step})
            .bind(commands, {in.tick, group.block, gpu::storageBuffer(3, shaded_), gpu::storageBuffer(4, field)});
        vkCmdDispatch(cmd, gpu::groups(gpu::groups(width, group.step) + 3, 8), gpu::groups(gpu::groups(rows, group.step) + 3, 8),
                      group.count());
        gpu::computeToCompute(cmd);
    }
    recordPresent(commands, group.block, in, group.view(), {width, rows, group.count()}, group.step);
}

void Compose::recordDrawnNodes(gpu::Commands& commands, const EyeInputs& in) {
    const VkCommandBuffer cmd = commands.handle();
    {
        const gpu::Commands::Pass pass(commands, "shade", in.view);
        gpu::computeToCompute(cmd);
        gpu::ComputeProgram& program = drawn_nodes_[in.step];
        if (!program)
            program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, shade_drawn_comp, "shade_drawn"},
                                          {{gpu::kIdStep, in.step}});
        program.bind(commands, {in.view_block, gpu::storageImage(2, *in.radiance), gpu::storageBuffer(3, shaded_)});
        vkCmdDispatch(cmd, gpu::groups(in.size.width, 8), gpu::groups(in.size.height, 8), 1);
        gpu::computeToCompute(cmd);
    }
    recordPresent(commands, in.view_block, in, in.view, {in.block->eye.size, 1}, in.step);
}

void Compose::recordPresent(gpu::Commands& commands, const gpu::Resource& views, const EyeInputs& any, uint32_t pass_view,
                            glm::uvec3 size, uint32_t step) {
    const gpu::Commands::Pass pass(commands, "present", pass_view);
    const VkCommandBuffer cmd = commands.handle();
    gpu::ComputeProgram& program = present_[{step, full_}];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, present_comp, "present"},
                                      {{gpu::kIdStep, step}, {gpu::kIdFull, full_}});
    program.bind(commands, {views, gpu::storageBuffer(3, *any.planes), gpu::storageBuffer(4, shaded_)});
    vkCmdDispatch(cmd, gpu::groups(size.x, 128), gpu::groups(size.y, 32), size.z);
}

} // namespace brume
