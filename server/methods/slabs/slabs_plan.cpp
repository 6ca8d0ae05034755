// Order-independent slabs as the plan sees them: every particle is added to the samples of the tiles and sheets that it
// reaches.
#include <algorithm>
#include <cmath>

#include "server/effects/local_lights/local_lights_plan.h"
#include "server/methods/rays/ray_plan.h"

namespace brume::methods::slabs {
namespace {

constexpr CostInfo kBin{"slab_bin", "bin", 5};      // particles x lines of tiles
constexpr CostInfo kSlabs{"slabs", "slabs", 0.066}; // particles x samples of the tiles and sheets that they reach
constexpr CostInfo kLamps{"slab_lamps", "slab light", 60}; // lampsOnRays()
constexpr CostInfo kLight{"slab_light", "slab light", 6};  // rays x slabs
constexpr const CostInfo* kCosts[] = {
    &kBin, &kSlabs, &kLight, &kLamps, &costs::kRayEnds, &costs::kComposeField, &costs::kShade, &costs::kPresent};

class Plan final : public RayPlan {
public:
    const char* name() const override { return "slabs"; }
    const char* about() const override {
        return "order-independent slabs on a coarse grid of rays, the full Gaussian, no sort";
    }
    std::string text(const RenderSettings& s) const override { return "slabs, " + raysText(s); }
    uint64_t bytesPerParticle() const override { return sizeof(gpu::SlabMember); }
    std::span<const CostInfo* const> costs() const override { return kCosts; }

    void addWays(const PlanScene& scene, const RenderSettings& way, bool, std::vector<RenderSettings>& ways,
                 std::string&) const override {
        addRays(scene, way, ways);
    }

    void addViewWork(const ViewWork& view, const RenderSettings& settings, Work& work) const override {
        addDisplayWork(view, settings, work);
        const PlanScene& scene = view.scene();
        if (!scene.needsRays()) return;
        const glm::dvec2 rays = raysOf(view, settings);
        const double tiles_x = std::ceil(rays.x / gpu::kSlabTile), tiles_y = std::ceil(rays.y / gpu::kSlabTile);
        const double sheets = groupsOf(settings.slabs, gpu::kSlabTile);
        const double side = double(gpu::kSlabTile) * settings.rate,
                     margin = double(kRayMargin) * settings.rate;                 // pixels
        const double sheet = std::max((view.far() - view.near()) / sheets, 1e-9); // m
        double reached = 0;
        for (const ViewWork::Seen& s : view.seen())
            reached += cellsTouched(s.left + margin, s.right + margin, side, tiles_x) *
                       cellsTouched(s.top + margin, s.bottom + margin, side, tiles_y) *
                       cellsTouched(s.near - view.near(), s.far - view.near(), sheet, sheets);
        constexpr double kSamples = double(gpu::kSlabTile) * gpu::kSlabTile * gpu::kSlabTile;
        const double once = 1.0 / scene.hues; // Bins and slabs run once, other passes once for each hue.
        work[kBin] = once * scene.particles * (tiles_x + tiles_y);
        work[kSlabs] =
            once * quantitiesOf(scene) * kSamples * (reached * scene.weight() + 0.5 * tiles_x * tiles_y * sheets);
        work[kLight] = rays.x * rays.y * settings.slabs * facesKept(view);
        work[kLamps] = lampsOnRays(view, settings);
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::slabs
