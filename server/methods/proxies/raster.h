// A method that draws one proxy per particle, far to near, with premultiplied blending.
#pragma once

#include <vector>

#include "server/methods/method.h"
#include "server/methods/proxies/depth_order.h"

namespace brume {

struct RasterInfo {
    DepthOrder::Support support{};
    std::vector<gpu::ShaderCode> shaders; // with a mesh stage: drawn by mesh tasks
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    uint32_t vertices = 0;                    // per particle, of the vertex stage
    uint32_t particles_per_group = 1;         // of the mesh stage
    std::vector<gpu::SpecConstant> constants; // beside those of the scene's features
    MethodNeeds needs;
    gpu::Buffer maps;                                    // Maps; with it ParticleLights is read
    glm::vec2 (*push)(const TickInputs& tick) = nullptr; // push constants of its shaders; null: they have none
};

std::unique_ptr<Method> makeRaster(const MethodContext& context, RasterInfo info);

} // namespace brume
