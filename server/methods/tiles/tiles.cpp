// Method `tiles`: projects particles to splats, lists them per block of tiles, and adds them near to far in every
// pixel. Quadrature `cached`: light is linear on every particle (light/particle_light.h). Quadrature `hermite`: it is
// looked up in the shadow volume at two points of each.
#include <algorithm>

#include "server/inputs/constants.h"
#include "server/methods/method.h"
#include "server/methods/plans.h"
#include "server/methods/proxies/depth_order.h"
#include "shaders/shared/splat.h"
#include "shaders/tiles_bin_comp.h"
#include "shaders/tiles_comp.h"
#include "shaders/tiles_project_comp.h"

namespace brume::methods::tiles {
namespace {

using gpu::storageBuffer;

constexpr VkExtent2D kTile{16, 8}; // pixels, as in shaders/lib/tiles.glsl
// A CPU driver is fastest where a lane does much; a GPU where there are many lanes.
constexpr uint32_t kPixelsPerLane = 16, kPixelsPerLaneOfGpu = 4;
// Pixels of a block of tiles with one list of splats. Blocks are doubled until all lists of a picture fit
// kMostMaskBytes.
constexpr VkExtent2D kBlock{64, 32};
constexpr VkDeviceSize kMostMaskBytes = 64 << 20;

class Tiles : public Method {
public:
    explicit Tiles(const MethodContext& context)
        : device_(context.device), order_(context.depth_order), cached_(context.settings.tiles.quadrature == "cached"),
          path_(context.settings.tiles.light == "path"), ellipsoids_(context.features.ellipsoids),
          project_(device_, {VK_SHADER_STAGE_COMPUTE_BIT, tiles_project_comp, "tiles_project"},
                   {{gpu::kIdCached, cached_}, {gpu::kIdEllipsoids, ellipsoids_}}),
          bin_(device_, {VK_SHADER_STAGE_COMPUTE_BIT, tiles_bin_comp, "tiles_bin"}),
          tiles_(device_, tiles_comp, "tiles") {}

    MethodNeeds needs() const override { return {.particle_light = cached_, .union_path = cached_ && path_}; }

    // Memory for all particles and the largest eye, which the eyes use one after another.
    std::span<const ViewGroup> prepare(std::span<const EyeInputs> eyes) override {
        VkDeviceSize words = 1, capacity = 1; // of the longest list
        for (const EyeInputs& in : eyes) {
            words = std::max<VkDeviceSize>(words, gpu::groups(in.medium->count, 32));
            capacity = std::max<VkDeviceSize>(capacity,
                                              in.resources.storage("Particles").buffer.range / sizeof(gpu::Particle));
        }
        const auto most = [&] { // bytes of masks
            uint32_t blocks = 1;
            for (const EyeInputs& in : eyes)
                blocks = std::max(blocks, gpu::groups(in.size.width, block_.width) *
                                              gpu::groups(in.size.height, block_.height));
            return words * blocks * sizeof(uint32_t);
        };
        for (block_ = kBlock; most() > kMostMaskBytes;) block_ = {block_.width * 2, block_.height * 2};
        grow(masks_, most(), "splat masks");
        grow(splats_, capacity * sizeof(gpu::Splat), "splats");
        if (ellipsoids_) grow(ways_, capacity * sizeof(gpu::SplatWay), "splat ways");
        grow(cones_, capacity * sizeof(gpu::SplatCone), "splat cones");
        return Method::prepare(eyes);
    }

    void recordGroup(gpu::Commands& commands, const ViewGroup& group) override {
        const EyeInputs& in = *group.any;
        const VkCommandBuffer cmd = commands.handle();
        order_.record(commands, in, DepthOrder::Support::sphere, 0, 1);
        gpu::computeToCompute(cmd);
        const gpu::SplatGrid grid{
            {gpu::groups(in.size.width, block_.width), gpu::groups(in.size.height, block_.height)},
            {block_.width, block_.height},
            in.shared->settings->tiles.least_transmittance};
        const gpu::Resource arguments = storageBuffer("Arguments", order_.arguments()),
                            cones = storageBuffer("Cones", cones_), splats = storageBuffer("Splats", splats_),
                            ways = storageBuffer("Ways", ellipsoids_ ? ways_ : splats_),
                            masks = storageBuffer("Masks", masks_);
        {
            const gpu::Commands::Pass pass(commands, "bin", in.view);
            project_.bind(commands, in.resources,
                          {storageBuffer("Order", order_.order()), arguments, cones, splats, ways});
            vkCmdDispatch(cmd, gpu::groups(in.medium->count, 64), 1, 1);
            gpu::computeToCompute(cmd);
            bin_.bind(commands, in.resources, {arguments, cones, masks}, grid);
            vkCmdDispatch(cmd, gpu::groups(grid.blocks.x * grid.blocks.y, 64), gpu::groups(in.medium->count, 32), 1);
            gpu::computeToCompute(cmd);
        }
        const gpu::Commands::Pass pass(commands, "medium", in.view);
        const uint32_t pixels = device_.isCpu() ? kPixelsPerLane : kPixelsPerLaneOfGpu;
        tiles_
            .with(constantsOf(in.shared->features),
                  {{gpu::kIdMayBeCut, in.shared->features.opaque || in.near_plane_cuts},
                   {gpu::kIdOneAlbedo, in.medium->extent->one_albedo},
                   {gpu::kIdCached, cached_},
                   {gpu::kIdPixelsPerLane, pixels},
                   {gpu::kIdTileLanes, kTile.width * kTile.height / pixels}})
            .bind(commands, in.resources, {arguments, cones, splats, ways, masks}, grid);
        vkCmdDispatch(cmd, gpu::groups(in.size.width, kTile.width), gpu::groups(in.size.height, kTile.height), 1);
        gpu::computeToCompute(cmd);
    }

private:
    void grow(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name) const {
        if (buffer && buffer.size() >= bytes) return;
        const VkDeviceSize most = device_.properties().limits.maxStorageBufferRange;
        if (bytes > most)
            throw gpu::Error("method tiles: " + std::string(name) + " of " + std::to_string(bytes >> 20) +
                             " MiB, the device allows " + std::to_string(most >> 20) + "; use fewer particles");
        buffer = gpu::Buffer(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, name);
    }

    const gpu::Device& device_;
    DepthOrder& order_;
    const bool cached_, path_, ellipsoids_;
    gpu::ComputeProgram project_, bin_;
    gpu::Variants tiles_;
    gpu::Buffer splats_, ways_, cones_, masks_;
    VkExtent2D block_ = kBlock;
};

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<Tiles>(context); }

} // namespace brume::methods::tiles
