// Method `slabs`: each eye adds all particles to slabs of a coarse grid of rays; their order does not matter.
// The medium's band limit says how coarse. Passes: ends of the rays at objects, bins, slabs, slab light,
// spline of the rays.
#include "server/inputs/line_bins.h"
#include "server/methods/rays/slab_rays.h"
#include "shaders/slab_bins_comp.h"
#include "shaders/slab_light_comp.h"
#include "shaders/slabs_comp.h"

namespace brume::methods::slabs {
namespace {

// Workgroups that keep a device busy.
constexpr uint32_t kGroupsOfCpu = 24, kGroupsOfGpu = 1 << 14;

class Slabs : public SlabRays {
public:
    explicit Slabs(const MethodContext& context)
        : SlabRays(context), ellipsoids_(context.features.ellipsoids),
          bins_program_(device_, {VK_SHADER_STAGE_COMPUTE_BIT, slab_bins_comp, "slab_bins"},
                        {{gpu::kIdEllipsoids, ellipsoids_}}),
          slabs_(device_, slabs_comp, "slabs"), light_(device_, slab_light_comp, "slab_light") {}

private:
    Elements elementsOf(const EyeInputs& in, const gpu::SlabGrid& grid) const override {
        const VkDeviceSize bits = lineBinBytes(grid.lines.x + grid.lines.y, in.medium->count);
        return {.members = in.medium->count,
                .bins = bits / sizeof(uint32_t),
                .added = VkDeviceSize(grid.lines.x) * grid.lines.y * grid.slabs * (kRaysOfTile / 4) * quantitiesOf(in)};
    }

    void growOwn(const Elements& elements) override {
        grow(members_, elements.members * sizeof(gpu::SlabMember), "slab members");
        if (ellipsoids_) grow(skews_, elements.members * sizeof(gpu::Skew), "slab skews");
        grow(bins_, elements.bins * sizeof(uint32_t), "slab bins");
        grow(added_, elements.added * sizeof(glm::vec4), "slab extinction");
    }

    static uint32_t quantitiesOf(const EyeInputs& in) { return gpu::mediumQuantities(in.medium->extent->one_albedo); }

    void recordRays(gpu::Commands& commands, const ViewGroup& group) override {
        const VkCommandBuffer cmd = commands.handle();
        const EyeInputs& in = *group.any;
        const uint32_t columns = group.most([](const gpu::View& v) { return v.grid.lines.x; });
        const uint32_t rows = group.most([](const gpu::View& v) { return v.grid.lines.y; });
        if (!in.shared->later_hue) {
            const gpu::Commands::Pass pass(commands, "bin", group.view());
            gpu::everythingBefore(cmd);
            if (group.bins > 0) vkCmdFillBuffer(cmd, bins_.handle(), 0, group.bins * sizeof(uint32_t), 0);
            gpu::transferToCompute(cmd);
            bins_program_.bind(commands, group.resources,
                               {gpu::storageBuffer("Members", members_), skews(), gpu::storageBuffer("Bins", bins_)});
            vkCmdDispatch(cmd, gpu::groups(in.medium->count, 32), 1, group.count());
            gpu::computeToCompute(cmd);
        }
        if (!in.shared->later_hue) {
            const gpu::Commands::Pass pass(commands, "slabs", group.view());
            const uint32_t sheets = group.most([](const gpu::View& v) { return v.grid.lines.z; });
            const uint32_t together = sheetsTogether(sheets, columns * rows * quantitiesOf(in) * group.count());
            struct Push {
                uint32_t parts, together, quantities;
            } push{gpu::groups(sheets, together), together, quantitiesOf(in)};
            slabs_
                .with(constantsOf(group),
                      {{gpu::kIdLanes, device_.lanesTogether()}, {gpu::kIdLockstep, device_.lockstep()}})
                .bind(commands, group.resources,
                      {gpu::storageBuffer("Members", members_), skews(), gpu::storageBuffer("Added", added_),
                       gpu::storageBuffer("Bins", bins_)},
                      push);
            vkCmdDispatch(cmd, columns, rows, push.parts * push.quantities * group.count());
            gpu::computeToCompute(cmd);
        }
        {
            const gpu::Commands::Pass pass(commands, "slab light", group.view());
            light_.with(constantsOf(group)).bind(commands, group.resources, {gpu::storageBuffer("Added", added_)});
            vkCmdDispatch(cmd, columns, rows, group.count());
            gpu::computeToCompute(cmd);
        }
    }

    // How many of the `sheets` of a tile a workgroup fills, if there are so many tiles, of all views and quantities.
    // All sheets of a tile share the list of its members, but workgroups should be enough for all cores.
    uint32_t sheetsTogether(uint32_t sheets, uint32_t tiles) const {
        const uint32_t wanted = device_.subgroupSize() > gpu::kSlabTile ? kGroupsOfGpu : kGroupsOfCpu;
        const uint32_t parts = std::clamp(gpu::groups(wanted, std::max(tiles, 1u)), 1u, sheets);
        return std::min(gpu::groups(sheets, parts), gpu::kMostTogether);
    }

    // Of ellipsoids; otherwise nothing reads what stands in.
    gpu::Resource skews() const { return gpu::storageBuffer("Skews", ellipsoids_ ? skews_ : members_); }

    const bool ellipsoids_;
    gpu::ComputeProgram bins_program_;
    gpu::Variants slabs_, light_;
    gpu::Buffer members_, skews_, bins_, added_;
};

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<Slabs>(context); }

} // namespace brume::methods::slabs
