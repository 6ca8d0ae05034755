#include "server/render/methods/grid.h"

#include "server/render/medium_grid.h"
#include "server/render/methods/slab_rays.h"
#include "shaders/grid_rays_comp.h"

namespace brume {
namespace {

class Grid : public SlabRays {
public:
    explicit Grid(const MethodContext& context) : SlabRays(context), medium_(context.device) {}

    bool sharesMedium() const override { return true; }
    void recordShared(gpu::Commands& commands, const EyeInputs& any) override {
        medium_.record(commands, {any.tick, any.particles, any.particle_version, any.particle_count, any.extent, any.settings});
    }

private:
    void recordRays(gpu::Commands& commands, const ViewGroup& group) override {
        const VkCommandBuffer cmd = commands.handle();
        const EyeInputs& in = *group.any;
        const uint32_t cubic = isCubic(*in.settings);
        const gpu::Commands::Pass pass(commands, "grid rays", group.view());
        gpu::computeToCompute(cmd);
        made(grid_rays_comp, "grid_rays", 2 * group.sources + cubic,
             {{gpu::kIdHasOpaque, features_.opaque}, {gpu::kIdCubic, cubic}, {gpu::kIdSources, group.sources}})
            .bind(commands,
                  {in.tick, group.block, gpu::storageBuffer(2, medium_.nodes()), gpu::storageBuffer(3, field_),
                   gpu::storageBuffer(5, medium_.marks()), gpu::sampledImage(6, *in.shadow_volume, *in.linear),
                   gpu::sampledImage(8, *in.view_depth, *in.nearest)},
                  medium_.grid());
        vkCmdDispatch(cmd, group.most([](const gpu::View& v) { return v.grid.lines.x; }),
                      group.most([](const gpu::View& v) { return v.grid.lines.y; }), group.count());
        gpu::computeToCompute(cmd);
    }

    GridPass medium_;
};

} // namespace

std::unique_ptr<Method> makeGrid(const MethodContext& context) { return std::make_unique<Grid>(context); }

} // namespace brume
