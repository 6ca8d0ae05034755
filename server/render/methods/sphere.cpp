#include "server/render/methods/sphere.h"

#include "server/render/raster.h"
#include "shaders/sphere_frag.h"
#include "shaders/sphere_vert.h"

namespace brume {

std::unique_ptr<Method> makeSphere(const MethodContext& context) {
    RasterInfo info;
    info.support = DepthOrder::Support::sphere;
    info.shaders = {{VK_SHADER_STAGE_VERTEX_BIT, sphere_vert, "sphere_vert"},
                    {VK_SHADER_STAGE_FRAGMENT_BIT, sphere_frag, "sphere_frag"}};
    info.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP;
    info.vertices = 8;
    return makeRaster(context, std::move(info));
}

} // namespace brume
