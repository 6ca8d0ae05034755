// The shared grid as the plan sees it: particles are added to nodes in world space once a tick, viewers pay for their
// rays only.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "server/effects/local_lights/local_lights_plan.h"
#include "server/methods/grid/node_grid_plan.h"
#include "server/methods/rays/ray_plan.h"

namespace brume::methods::grid {
namespace {

constexpr CostInfo kBins{"grid_bin", "grid bins", 14}; // particles x lines of bricks
// Particles x nodes of the bricks that they reach, and nodes x what makes them of coarse ones.
constexpr CostInfo kNodes{"grid", "grid", 0.06};
constexpr CostInfo kLamps{"grid_lamps", "grid rays", 60}; // lampsOnRays()
// Rays x slabs x (1, or 5 where sampling is cubic; with several albedos 4 times that).
constexpr CostInfo kRays{"grid_rays", "grid rays", 12};
constexpr const CostInfo* kCosts[] = {
    &kBins, &kNodes, &kRays, &kLamps, &costs::kRayEnds, &costs::kComposeField, &costs::kShade, &costs::kPresent};

constexpr float kSpacings[] = {0.2f, 0.3f, 0.4f, 0.5f, 0.7f}; // standard deviations; cubic below kCubicBelow
constexpr double kCoarseReach = 0.42; // of a particle on coarse nodes: these are narrower, and twice as far apart
constexpr double kInterpolated = 12;  // particles that cost as much as a brick's interpolation from coarse nodes
constexpr double kCubicSampling = 5;  // what a sample then costs, over a linear one

class Plan final : public RayPlan {
public:
    bool draws(std::string_view model) const override { return RayPlan::draws(model) || model == kVolumeMedium; }
    const char* name() const override { return "grid"; }
    const char* about() const override {
        return "slabs sampled from a grid in world space that all viewers share, the full Gaussian";
    }
    std::string text(const RenderSettings& s) const override {
        return fmt::format("grid, nodes {:.3g} deviations apart, {}", s.grid.spacing, raysText(s));
    }
    uint32_t shaders(const RenderSettings& settings) const override {
        return kScatteringShaders * uint32_t(isCubic(settings)) + RayPlan::shaders(settings);
    }
    uint64_t bytesPerParticle() const override { return sizeof(gpu::SlabMember); }
    std::span<const CostInfo* const> costs() const override { return kCosts; }

    void addWays(const PlanScene& scene, const RenderSettings& wanted, bool, std::vector<RenderSettings>& ways,
                 std::string& refused) const override {
        RenderSettings way = wanted;
        for (const float spacing : kSpacings) {
            if (wanted.grid.spacing != kAuto && spacing != kSpacings[0]) break;
            way.grid.spacing = wanted.grid.spacing != kAuto ? wanted.grid.spacing : spacing;
            const std::string why = gridRefusal(scene.extent, way);
            if (why.empty()) addRays(scene, way, ways);
            refused = why.empty() ? why : "grid: " + why; // the coarsest one's is kept
        }
    }

    void addSharedWork(const PlanScene& scene, const RenderSettings& settings, Work& work) const override {
        const gpu::MediumGrid grid = mediumGrid(scene.extent, settings);
        const glm::dvec3 bricks(grid.bricks);
        // Bricks that the particles' own nodes lie in, and all bricks that have medium.
        double reached = 0, filled = 0;
        for (const gpu::Particle& p : scene.sample) {
            const double reach = 2 * scene.support(p) / double(grid.spacing) / gpu::kSlabTile;
            if (reach <= 0) continue;
            const auto touched = [&](double r) {
                return std::min(r + 1, bricks.x) * std::min(r + 1, bricks.y) * std::min(r + 1, bricks.z);
            };
            const bool is_coarse =
                0.1 * double(p.scale) * double(scene.tick.falloff) >= double(grid.least_coarse) * double(grid.spacing);
            filled += touched(reach);
            reached += touched(is_coarse ? kCoarseReach * reach : reach);
        }
        constexpr double kNodesOfBrick = double(gpu::kSlabTile) * gpu::kSlabTile * gpu::kSlabTile;
        const double all = bricks.x * bricks.y * bricks.z;
        work[kBins] = scene.particles * (bricks.x + bricks.y + bricks.z);
        work[kNodes] = quantitiesOf(scene) * kNodesOfBrick *
                       (reached * scene.weight() +
                        (hasCoarse(grid) ? kInterpolated * std::min(filled * scene.weight(), all) : 0.5 * all));
    }

    void addViewWork(const ViewWork& view, const RenderSettings& settings, Work& work) const override {
        addDisplayWork(view, settings, work);
        if (!view.scene().needsRays()) return;
        const glm::dvec2 rays = raysOf(view, settings);
        work[kRays] = rays.x * rays.y * settings.slabs * (isCubic(settings) ? kCubicSampling : 1) *
                      quantitiesOf(view.scene()) * facesKept(view);
        work[kLamps] = lampsOnRays(view, settings);
    }

private:
    bool widens() const override { return false; }
    // Of one size of particles, with linear sampling, then with cubic: upper bounds of what was measured of single
    // particles, and of cloud, cloud-5000, tubes and plume.
    double nodeError(const RenderSettings& settings, const ViewWork& view) const override {
        const double spacing = double(settings.grid.spacing) * double(view.scene().extent.deviation);
        double sum = 0;
        for (const SeenLight::Size& size : view.light().sizes()) {
            const double x = spacing / size.deviation;
            const double coarse = x * double(kLeastCoarse) <= 1 ? 0.1 * std::pow(x, 4) : 0;
            const double e = isCubic(settings) ? 0.005 * std::pow(x, 4) : 0.05 * x * x + coarse;
            sum += size.part * std::pow(e / (1 + e), 2);
        }
        return std::sqrt(sum);
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::grid
