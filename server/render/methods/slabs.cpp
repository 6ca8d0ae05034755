#include "server/render/methods/slabs.h"

#include "server/render/line_bins.h"
#include "server/render/methods/slab_rays.h"
#include "shaders/slab_bins_comp.h"
#include "shaders/slab_light_comp.h"
#include "shaders/slabs_comp.h"

namespace brume {
namespace {

class Slabs : public SlabRays {
public:
    explicit Slabs(const MethodContext& context)
        : SlabRays(context), bins_program_(device_, {VK_SHADER_STAGE_COMPUTE_BIT, slab_bins_comp, "slab_bins"}) {}

private:
    VkDeviceSize bandBytes(const gpu::SlabGrid& grid, uint32_t sources) const override {
        return VkDeviceSize(grid.lines.x) * grid.lines.y * grid.slabs * kRaysOfTile * (sources > 1 ? 4 : 1) * sizeof(float);
    }

    static VkDeviceSize binBytes(const EyeInputs& in, const gpu::SlabGrid& grid) {
        return lineBinBytes(grid.lines.x + grid.lines.y + grid.lines.z, in.particle_count);
    }

    void fitBand(const EyeInputs& in, const gpu::SlabGrid& grid, uint32_t sources) override {
        fit(members_, in.particle_count * sizeof(gpu::SlabMember), "slab members");
        fit(bins_, binBytes(in, grid), "slab bins");
        fit(added_, bandBytes(grid, sources), "slab extinction");
    }

    void recordBand(gpu::Commands& commands, const EyeInputs& in, const gpu::SlabGrid& grid, uint32_t sources) override {
        const VkCommandBuffer cmd = commands.handle();
        {
            const gpu::Commands::Pass pass(commands, "bin", in.view);
            gpu::everythingBefore(cmd);
            vkCmdFillBuffer(cmd, bins_.handle(), 0, binBytes(in, grid), 0);
            gpu::transferToCompute(cmd);
            bins_program_.bind(cmd,
                               {in.tick, in.eye, gpu::storageBuffer(2, *in.particles), gpu::storageBuffer(3, members_),
                                gpu::storageBuffer(4, bins_)},
                               grid);
            vkCmdDispatch(cmd, gpu::groups(in.particle_count, 32), 1, 1);
            gpu::computeToCompute(cmd);
        }
        {
            const gpu::Commands::Pass pass(commands, "slabs", in.view);
            made(slabs_comp, "slabs", grid.sheet, {{20, grid.sheet}})
                .bind(cmd,
                      {in.tick, in.eye, gpu::storageBuffer(2, members_), gpu::storageBuffer(3, added_),
                       gpu::storageBuffer(4, bins_)},
                      grid);
            vkCmdDispatch(cmd, grid.lines.x, grid.lines.y, grid.lines.z * (sources > 1 ? 4 : 1));
            gpu::computeToCompute(cmd);
        }
        {
            const gpu::Commands::Pass pass(commands, "slab light", in.view);
            made(slab_light_comp, "slab_light", sources, {{0, features_.opaque}, {24, sources}})
                .bind(cmd,
                      {in.tick, in.eye, gpu::storageBuffer(2, added_), gpu::storageBuffer(3, field_),
                       gpu::sampledImage(6, *in.shadow_volume, *in.linear), gpu::sampledImage(8, *in.view_depth, *in.nearest)},
                      grid);
            vkCmdDispatch(cmd, grid.lines.x, grid.lines.y, 1);
            gpu::computeToCompute(cmd);
        }
    }

    gpu::ComputeProgram bins_program_;
    gpu::Buffer members_, bins_, added_;
};

} // namespace

std::unique_ptr<Method> makeSlabs(const MethodContext& context) { return std::make_unique<Slabs>(context); }

} // namespace brume
