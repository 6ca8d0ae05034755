#include "server/opaque/surfaces.h"

#include "shaders/background_comp.h"
#include "shaders/background_frag.h"
#include "shaders/background_vert.h"

namespace brume {

Surfaces::Surfaces(const gpu::Device& device, const Scene& scene, bool by_draw) {
    const gpu::SpecConstant planes{gpu::kIdPlanes, uint32_t(scene.planes.size())},
        boxes{gpu::kIdBoxes, uint32_t(scene.boxes.size())}, spheres{gpu::kIdSpheres, uint32_t(scene.spheres.size())};
    if (by_draw) {
        const gpu::ShaderCode shaders[] = {{VK_SHADER_STAGE_VERTEX_BIT, background_vert, "background"},
                                           {VK_SHADER_STAGE_FRAGMENT_BIT, background_frag, "background"}};
        const gpu::SpecConstant constants[] = {planes, boxes, spheres};
        gpu::GraphicsInfo graphics;
        graphics.formats = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_SFLOAT};
        graphics.blend = gpu::Blend::replace;
        draw_ = gpu::GraphicsProgram(device, shaders, graphics, constants);
    } else {
        compute_ = gpu::ComputeProgram(device, {VK_SHADER_STAGE_COMPUTE_BIT, background_comp, "background"},
                                       {planes, boxes, spheres});
    }
}

void Surfaces::record(gpu::Commands& commands, const EyeInputs& in) const {
    const gpu::Commands::Pass pass(commands, "opaque", in.view);
    const VkCommandBuffer cmd = commands.handle();
    gpu::everythingBefore(cmd); // the eye before has used the same targets
    const gpu::Resource objects = gpu::uniformBuffer(2, *in.shared->objects, 0, in.shared->objects->size()),
                        light = gpu::sampledImage(3, *in.shared->shadow_volume, *in.shared->linear),
                        casters = gpu::sampledImage(4, *in.shared->opaque_shadow, *in.shared->nearest);
    if (draw_) {
        gpu::beginDrawing(cmd, in.size, {&in.target->radiance, &in.target->view_depth});
        draw_.bind(commands, {in.medium->tick, in.eye, objects, light, casters});
        vkCmdDraw(cmd, 3, 1, 0, 0);
        vkCmdEndRendering(cmd);
    } else {
        compute_.bind(commands,
                      {in.medium->tick, in.eye, objects, light, casters, gpu::storageImage(5, in.target->radiance),
                       gpu::storageImage(6, in.target->view_depth)});
        vkCmdDispatch(cmd, gpu::groups(in.size.width, 8), gpu::groups(in.size.height, 8), 1);
    }
    gpu::everythingBefore(cmd);
}

} // namespace brume
