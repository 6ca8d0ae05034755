#include "server/methods/lit/lit_rays.h"

#include "server/inputs/constants.h"
#include "shaders/lit_rays_comp.h"

namespace brume {

LitRays::LitRays(const MethodContext& context)
    : FroxelVolume(context), nodes_(context.device, context.features.ellipsoids),
      program_(context.device, lit_rays_comp, "lit_rays") {}

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
    program_.with(constantsOf(shared.features), {{gpu::kIdOneAlbedo, in.medium->extent->one_albedo}})
        .bind(commands, in.resources,
              {gpu::storageBuffer("Nodes", nodes_.nodes()), gpu::storageBuffer("Volume", volume()),
               gpu::storageBuffer("Furthest", furthest()), gpu::storageBuffer("Marks", nodes_.marks()),
               gpu::storageBuffer("LitNodes", lit.light.nodes), gpu::storageBuffer("SunNodes", lit.light.sun)},
              push);
    vkCmdDispatch(commands.handle(), gpu::groups(froxels.rays.x, 8), gpu::groups(froxels.rays.y, 8), 1);
    gpu::computeToCompute(commands.handle());
}

} // namespace brume
