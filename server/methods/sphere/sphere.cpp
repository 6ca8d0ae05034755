// Sphere proxies with the full Gaussian (seed 000 section 6.2 names them as future work).
#include "server/methods/proxies/raster.h"
#include "shaders/sphere_frag.h"
#include "shaders/sphere_vert.h"

namespace brume::methods::sphere {

std::unique_ptr<Method> make(const MethodContext& context) {
    RasterInfo info;
    info.support = DepthOrder::Support::sphere;
    info.shaders = {{VK_SHADER_STAGE_VERTEX_BIT, sphere_vert, "sphere_vert"},
                    {VK_SHADER_STAGE_FRAGMENT_BIT, sphere_frag, "sphere_frag"}};
    info.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP;
    info.vertices = 8;
    return makeRaster(context, std::move(info));
}

} // namespace brume::methods::sphere
