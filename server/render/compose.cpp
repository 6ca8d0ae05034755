#include "server/render/compose.h"

#include "shaders/compose_comp.h"

namespace brume {

Compose::Compose(const gpu::Device& device, const SceneFeatures& features)
    : device_(device), features_(features),
      none_(device, 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "no field") {}

const gpu::ComputeProgram& Compose::program(const Variant& v) {
    gpu::ComputeProgram& program = programs_[v];
    if (!program)
        program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, compose_comp, "compose"},
                                      {{0, features_.opaque},
                                       {1, features_.casters},
                                       {2, v.lobe},
                                       {3, features_.ambient},
                                       {23, v.rate},
                                       {24, v.sources},
                                       {25, v.drawn},
                                       {26, v.keep}});
    return program;
}

void Compose::record(gpu::Commands& commands, const EyeInputs& in, uint32_t first, uint32_t count, const MediumField* field) {
    const gpu::Commands::Pass pass(commands, "compose", in.view);
    const VkCommandBuffer cmd = commands.handle();
    gpu::computeToCompute(cmd);
    struct Push {
        uint32_t luma_words, first_word, first, end;
        gpu::SlabGrid grid;
    };
    const PlaneLayout layout{in.size.width, in.size.height};
    const Push push{layout.lumaStride() / 4, uint32_t(in.planes_at / 4), first, first + count,
                    field ? field->grid : gpu::SlabGrid{}};
    const Variant variant =
        field ? Variant{false, keep_, in.lobe, field->grid.rate, field->sources} : Variant{true, false, false, 8, 1};
    program(variant).bind(cmd,
                          {in.tick, in.eye, gpu::storageImage(2, *in.radiance), gpu::storageBuffer(3, *in.planes),
                           gpu::storageBuffer(4, field ? *field->buffer : none_),
                           gpu::uniformBuffer(5, *in.objects, 0, in.objects->size()),
                           gpu::sampledImage(8, *in.view_depth, *in.nearest)},
                          push);
    vkCmdDispatch(cmd, gpu::groups(layout.lumaStride() / 8, 8), gpu::groups((count + 1) / 2, 8), 1);
}

} // namespace brume
