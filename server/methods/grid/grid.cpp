// Method `grid`: adds particles once per tick to nodes in world space. Each eye marches a coarse grid of rays through
// them, so a viewer's cost does not depend on the number of particles.
#include "server/methods/grid/medium_grid.h"
#include "server/methods/rays/slab_rays.h"
#include "shaders/grid_rays_comp.h"

namespace brume::methods::grid {
namespace {

class Grid : public SlabRays {
public:
    explicit Grid(const MethodContext& context)
        : SlabRays(context), medium_(context.device, context.features.ellipsoids),
          rays_(context.device, grid_rays_comp, "grid_rays") {}

    MethodNeeds needs() const override { return {.one_medium = true, .writes_target = false}; }
    void recordTick(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium) override {
        medium_.record(commands, medium, *tick.settings);
    }

private:
    void recordRays(gpu::Commands& commands, const ViewGroup& group) override {
        const VkCommandBuffer cmd = commands.handle();
        const EyeInputs& in = *group.any;
        const uint32_t cubic = !in.medium->volume && isCubic(*in.shared->settings);
        const gpu::Commands::Pass pass(commands, "grid rays", group.view());
        gpu::computeToCompute(cmd);
        rays_.with(constantsOf(group), {{gpu::kIdCubic, cubic}})
            .bind(commands, group.resources,
                  {gpu::storageBuffer("Nodes", medium_.nodes()), gpu::storageBuffer("Marks", medium_.marks())},
                  medium_.grid());
        vkCmdDispatch(cmd, group.most([](const gpu::View& v) { return v.grid.lines.x; }),
                      group.most([](const gpu::View& v) { return v.grid.lines.y; }), group.count());
        gpu::computeToCompute(cmd);
    }

    GridPass medium_;
    gpu::Variants rays_;
};

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<Grid>(context); }

} // namespace brume::methods::grid
