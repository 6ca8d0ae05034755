// Interval shaded volumetrics (seed 000): tetrahedra as interval proxies, by mesh shader where the device has it.
#include "server/methods/isv/quadrature.h"
#include "server/methods/proxies/raster.h"
#include "shaders/isv_frag.h"
#include "shaders/isv_mesh.h"
#include "shaders/isv_vert.h"

namespace brume::methods::isv {
namespace {

// Push of shaders/isv.frag.
glm::vec2 pushOf(const TickInputs& tick) { return {tick.settings->isv.multiple, tick.settings->isv.taylor_step}; }

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) {
    const IsvSettings& settings = context.settings.isv;
    RasterInfo info;
    info.support = settings.fading ? DepthOrder::Support::tetrahedron : DepthOrder::Support::even_tetrahedron;
    if (context.device.hasMeshShaders())
        info.shaders = {{VK_SHADER_STAGE_MESH_BIT_EXT, isv_mesh, "isv_mesh"}};
    else
        info.shaders = {{VK_SHADER_STAGE_VERTEX_BIT, isv_vert, "isv_vert"}};
    info.shaders.push_back({VK_SHADER_STAGE_FRAGMENT_BIT, isv_frag, "isv_frag"});
    info.vertices = 12;
    info.particles_per_group = 32; // as in isv.mesh
    info.constants = {{gpu::kIdQuadrature, quadratureId(settings)},
                      {gpu::kIdSteps, settings.steps},
                      {gpu::kIdFading, settings.fading},
                      {gpu::kIdSoftShadows, settings.soft_shadows},
                      {gpu::kIdLegacyTerm, settings.multiple > 0},
                      {gpu::kIdTurned, isTurned(settings)},
                      {gpu::kIdDropsNear, dropsNear(settings)},
                      {gpu::kIdEarlyReturn, earlyReturnId(settings)},
                      {gpu::kIdTaylorStep, settings.taylor_step > 0},
                      {gpu::kIdTaylorShadows, settings.taylor_shadows}};
    info.push = pushOf;
    return makeRaster(context, std::move(info));
}

} // namespace brume::methods::isv
