#include "server/opaque/surfaces.h"

#include "shaders/background_comp.h"
#include "shaders/background_frag.h"
#include "shaders/background_vert.h"

namespace brume {

Surfaces::Surfaces(const gpu::Device& device, const Scene& scene, bool by_draw)
    : device_(device), planes_{gpu::kIdPlanes, uint32_t(scene.planes.size())},
      boxes_{gpu::kIdBoxes, uint32_t(scene.boxes.size())}, spheres_{gpu::kIdSpheres, uint32_t(scene.spheres.size())},
      by_draw_(by_draw) {}

const Surfaces::Programs& Surfaces::programsFor(bool fog, bool local_lights) {
    Programs& made = programs_[{fog, local_lights}];
    const gpu::SpecConstant has_fog{gpu::kIdHasFog, fog}, has_lights{gpu::kIdHasLocalLights, local_lights};
    if (by_draw_ && !made.draw) {
        const gpu::ShaderCode shaders[] = {{VK_SHADER_STAGE_VERTEX_BIT, background_vert, "background"},
                                           {VK_SHADER_STAGE_FRAGMENT_BIT, background_frag, "background"}};
        const gpu::SpecConstant constants[] = {planes_, boxes_, spheres_, has_fog, has_lights};
        gpu::GraphicsInfo graphics;
        graphics.formats = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_SFLOAT};
        graphics.blend = gpu::Blend::replace;
        made.draw = gpu::GraphicsProgram(device_, shaders, graphics, constants);
    }
    if (!by_draw_ && !made.compute)
        made.compute = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, background_comp, "background"},
                                           {planes_, boxes_, spheres_, has_fog, has_lights});
    return made;
}

void Surfaces::record(gpu::Commands& commands, const EyeInputs& in) {
    const gpu::Commands::Pass pass(commands, "opaque", in.view);
    const VkCommandBuffer cmd = commands.handle();
    gpu::everythingBefore(cmd); // the eye before has used the same targets
    const gpu::Resource objects = gpu::uniformBuffer(2, *in.shared->objects, 0, in.shared->objects->size()),
                        light = gpu::sampledImage(3, *in.shared->shadow_volume, *in.shared->linear),
                        casters = gpu::sampledImage(4, *in.shared->opaque_shadow, *in.shared->nearest),
                        lights = gpu::storageBuffer(7, *in.shared->local_lights),
                        bits = gpu::storageBuffer(8, *in.shared->light_bits),
                        depths = gpu::storageBuffer(9, *in.shared->light_depths);
    const Programs& programs = programsFor(in.shared->features.fog, in.shared->features.local_lights);
    if (by_draw_) {
        gpu::beginDrawing(cmd, in.size, {&in.target->radiance, &in.target->view_depth});
        programs.draw.bind(commands, {in.medium->tick, in.eye, objects, light, casters, lights, bits, depths});
        vkCmdDraw(cmd, 3, 1, 0, 0);
        vkCmdEndRendering(cmd);
    } else {
        programs.compute.bind(commands,
                              {in.medium->tick, in.eye, objects, light, casters, lights, bits, depths,
                               gpu::storageImage(5, in.target->radiance), gpu::storageImage(6, in.target->view_depth)});
        vkCmdDispatch(cmd, gpu::groups(in.size.width, 8), gpu::groups(in.size.height, 8), 1);
    }
    gpu::everythingBefore(cmd);
}

} // namespace brume
