#include "server/methods/lit/lit_rays.h"

#include "shaders/lit_rays_comp.h"

namespace brume {

void LitRays::recordTick(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium) {
    nodes_.record(commands, medium, *tick.settings, true);
    recordLight(commands, tick, medium, nodes_);
}

void LitRays::recordRays(gpu::Commands& commands, const EyeInputs& in, const gpu::FroxelGrid& froxels) {
    const TickInputs& shared = *in.shared;
    const Light lit = recordLight(commands, shared, *in.medium, nodes_);
    const gpu::Commands::Pass pass(commands, "lit rays", in.view);
    const struct {
        gpu::FroxelGrid froxels;
        gpu::MediumGrid medium;
        gpu::LitGridShape lit;
        glm::vec3 albedo;
    } push{froxels, nodes_.grid(), lit.shape, in.medium->extent->albedo};
    program(in.medium->extent->one_albedo)
        .bind(commands,
              {in.medium->tick, in.eye, gpu::storageBuffer(2, nodes_.nodes()), gpu::storageBuffer(3, volume()),
               gpu::storageBuffer(4, furthest()), gpu::storageBuffer(5, nodes_.marks()),
               gpu::sampledImage(6, *shared.shadow_volume, *shared.linear),
               gpu::sampledImage(7, *shared.opaque_shadow, *shared.nearest),
               gpu::storageBuffer(8, *shared.local_lights), gpu::storageBuffer(9, *shared.light_bits),
               gpu::storageBuffer(10, *shared.light_depths), gpu::storageBuffer(11, *shared.objects),
               gpu::storageBuffer(12, *shared.object_nodes), gpu::storageBuffer(13, *shared.triangles),
               gpu::storageBuffer(14, *shared.mesh_nodes), gpu::storageBuffer(15, lit.light.nodes),
               gpu::storageBuffer(16, lit.light.sun)},
              push);
    vkCmdDispatch(commands.handle(), gpu::groups(froxels.rays.x, 8), gpu::groups(froxels.rays.y, 8), 1);
    gpu::computeToCompute(commands.handle());
}

const gpu::ComputeProgram& LitRays::program(bool one_albedo) {
    gpu::ComputeProgram& made = programs_[one_albedo];
    if (!made)
        made = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, lit_rays_comp, "lit_rays"},
                                   {{gpu::kIdHasOpaque, features_.opaque},
                                    {gpu::kIdHasCasters, features_.casters},
                                    {gpu::kIdHasMeshes, features_.meshes},
                                    {gpu::kIdHasAmbient, features_.ambient},
                                    {gpu::kIdHasFog, features_.fog},
                                    {gpu::kIdHasGlow, features_.glow},
                                    {gpu::kIdHasLocalLights, features_.local_lights},
                                    {gpu::kIdOneAlbedo, one_albedo}});
    return made;
}

} // namespace brume
