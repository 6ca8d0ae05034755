#include "server/render/depth_layers.h"

#include "server/inputs/constants.h"
#include "shaders/depth_layers_comp.h"
#include "shaders/surface_depth_comp.h"

namespace brume {
DepthLayers::DepthLayers(const gpu::Device& device)
    : layers_(device, depth_layers_comp, "depth_layers"),
      surface_(device, {VK_SHADER_STAGE_COMPUTE_BIT, surface_depth_comp, "surface_depth"}) {}

void DepthLayers::place(const EyeRequest& eye, bool surfaces, VkDeviceSize at, gpu::DepthLayers& layers) {
    if (eye.depth_layers == 0) return;
    layers.colours = uint32_t(at / sizeof(uint32_t));
    const uint64_t lattice = latticeBytes(eye.width, eye.height, eye.depth_layers);
    layers.surface = surfaces ? layers.colours + uint32_t(lattice / sizeof(uint32_t)) : 0;
}

DepthLayersView DepthLayers::viewOf(const gpu::View& view, const uint8_t* planes) {
    const gpu::DepthLayers& layers = view.layers;
    DepthLayersView out{.count = layers.count,
                        .columns = layers.nodes.x,
                        .rows = layers.nodes.y,
                        .block_rows = layers.rows,
                        .near = layers.near,
                        .far = layers.far,
                        .exposure = view.eye.exposure,
                        .filmic = view.eye.filmic != 0};
    if (layers.surface > 0) out.surface = planes + sizeof(uint32_t) * layers.surface;
    if (layers.count == 0) return out;
    out.spacing = layers.every * view.grid.rate;
    out.first = (float(layers.first) - float(view.grid.margin)) * float(view.grid.rate) + 0.5f;
    out.colours = {{layers.nodes.x, layers.blocks * layers.rows, true}, planes + sizeof(uint32_t) * layers.colours};
    out.data = planes + sizeof(uint32_t) * layers.data;
    return out;
}

void DepthLayers::record(gpu::Commands& commands, const ViewGroup& group) {
    const VkCommandBuffer cmd = commands.handle();
    for (uint32_t i = 0; i < group.count(); ++i) {
        const gpu::View& view = group.views[i];
        const gpu::DepthLayers& layers = view.layers;
        if (layers.surface > 0) {
            const gpu::Commands::Pass pass(commands, "surface depth", group.any->view);
            gpu::computeToCompute(cmd);
            surface_.bind(commands, group.resources, {group.blockOf(i)});
            vkCmdDispatch(cmd, gpu::groups(view.eye.size.x, 32), gpu::groups(view.end - view.first, 8), 1);
        }
        if (!group.field || layers.count == 0) continue;
        const gpu::Commands::Pass pass(commands, "depth layers", group.view());
        gpu::computeToCompute(cmd);
        layers_.with(constantsOf(group)).bind(commands, group.resources, {group.blockOf(i)});
        vkCmdDispatch(cmd, gpu::groups(gpu::layerWords(layers.nodes.x), 8), layers.rows / 8, layers.blocks);
    }
}

} // namespace brume
