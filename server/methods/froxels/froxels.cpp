// Method `froxels`: every eye's view volume is cut into froxels, each with one sample of medium and light, as engines
// do after Hillaire (2015). The known baseline beside which caches are judged.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "server/gpu/program.h"
#include "server/inputs/constants.h"
#include "server/inputs/world_box.h"
#include "server/methods/froxels/froxel_history.h"
#include "server/methods/froxels/froxel_shaders.h"
#include "server/methods/froxels/froxel_volume.h"
#include "server/methods/froxels/shadow_frustum.h"
#include "server/methods/froxels/shadow_grid.h"
#include "server/methods/grid/medium_grid.h"
#include "shaders/froxels_comp.h"

namespace brume::methods::froxels {
namespace {

// Part of the slices, from the eye on, that the shadow frustum covers. docs/results/seed-002.md measures this one.
constexpr float kFrustumPart = 0.333f;

class Froxels : public FroxelVolume {
public:
    explicit Froxels(const MethodContext& context)
        : FroxelVolume(context), nodes_(context.device, context.features.ellipsoids), grid_(context.device),
          frusta_(context.device), history_(context.device), program_(context.device, froxels_comp, "froxels") {}

    std::span<const ViewGroup> prepare(std::span<const EyeInputs> eyes) override {
        history_.forgetOld();
        eyes_.clear(), slices_.clear();
        far_ = 0;
        for (const EyeInputs& in : eyes) {
            const gpu::FroxelGrid froxels = froxelSlices(in);
            const auto count = uint32_t(kFrustumPart * float(froxels.slices) + 0.5f);
            eyes_.push_back(in.block->eye);
            slices_.push_back({count, froxels.near, froxels.unit, froxels.growth});
            far_ =
                std::max(far_, froxels.near + froxels.unit * (std::exp2(froxels.growth * float(froxels.slices)) - 1));
        }
        return FroxelVolume::prepare(eyes);
    }

    void recordTick(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium) override {
        nodes_.record(commands, medium, *tick.settings, true);
        const uint32_t shadows = shadersFor(tick.settings->froxels).shadows;
        if (shadows != gpu::kShadowsByGrid && shadows != gpu::kShadowsHybrid) return;
        Bounds3 box = worldBox(tick, medium);
        if (!(box.lo.x <= box.hi.x)) box = {glm::dvec3(-1), glm::dvec3(1)}; // nothing throws shadows
        grid_.record(commands, {.resources = medium.resources,
                                .tick = *tick.tick,
                                .shared = tick,
                                .lights = tick.lights,
                                .lo = box.lo,
                                .hi = box.hi,
                                .eyes = eyes_,
                                .far = far_,
                                .margin = float(tick.settings->froxels.pixels),
                                .key = tick.objects_version});
        if (shadows == gpu::kShadowsHybrid) frusta_.record(commands, medium.resources, tick, grid_, eyes_, slices_);
    }

    LightWork workSince() override { return {.voxel_rays = grid_.raysSince(), .froxel_rays = frusta_.raysSince()}; }

private:
    void recordRays(gpu::Commands& commands, const EyeInputs& in, const gpu::FroxelGrid& froxels) override {
        const gpu::Commands::Pass pass(commands, "froxels", in.view);
        const TickInputs& shared = *in.shared;
        const auto tick = shared.settings->froxels.jitter ? uint32_t(shared.number % 64) + 64 : 0; // never 0
        const struct {
            gpu::FroxelGrid froxels;
            gpu::MediumGrid medium;
            glm::vec3 albedo;
            uint32_t view, jitter;
        } push{froxels, nodes_.grid(), in.medium->extent->albedo, in.view, tick};
        const bool whole = froxels.first_row == 0 && (froxels.rays.y - 1) * froxels.pixels >= in.size.height;
        const FroxelHistory::Bound history = history_.record(commands, in, froxels, whole);
        // A buffer that this way does not have is not read.
        const auto orAny = [&in](std::string_view name, const gpu::Buffer& buffer) {
            return buffer ? gpu::storageBuffer(name, buffer) : in.resources.storage("Objects").as(name);
        };
        FroxelShaders shaders = shadersFor(shared.settings->froxels);
        shaders.history = shaders.history && history.has;
        program_
            .with(constantsOf(shared.features), {{gpu::kIdOneAlbedo, in.medium->extent->one_albedo},
                                                 {gpu::kIdShadows, shaders.shadows},
                                                 {gpu::kIdHistory, shaders.history}})
            .bind(commands, in.resources,
                  {gpu::storageBuffer("Nodes", nodes_.nodes()), gpu::storageBuffer("Volume", volume()),
                   gpu::storageBuffer("Furthest", furthest()), gpu::storageBuffer("Marks", nodes_.marks()),
                   gpu::uniformBuffer("GridBlock", grid_.block(), 0, sizeof(gpu::ShadowGridBlock)),
                   orAny("Voxels", grid_.voxels()), orAny("Slots", grid_.slots()), orAny("Frusta", frusta_.frusta()),
                   orAny("FrustumBits", frusta_.froxels()), gpu::storageBuffer("Cells", *history.cells),
                   gpu::uniformBuffer("HistoryOfEye", *history.block, 0, sizeof(gpu::HistoryBlock))},
                  push);
        vkCmdDispatch(commands.handle(), gpu::groups(froxels.rays.x, 8), gpu::groups(froxels.rays.y, 8), 1);
        gpu::computeToCompute(commands.handle());
    }

    GridPass nodes_;
    ShadowGrid grid_;
    ShadowFrusta frusta_;
    // Of this submission.
    std::vector<gpu::Eye> eyes_;
    std::vector<ShadowSlices> slices_; // that the frusta cover
    float far_ = 0;                    // m of view depth, where the slices of all eyes end
    FroxelHistory history_;
    gpu::Variants program_;
};

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<Froxels>(context); }

} // namespace brume::methods::froxels
