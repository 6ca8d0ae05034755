// Compute tiles as the plan sees them.
#include <fmt/format.h>

#include "common/scene_limits.h"
#include "server/effects/particle_light/particle_light_plan.h"
#include "server/effects/union_path/union_path_plan.h"
#include "server/methods/proxies/proxy_plan.h"
#include "shaders/shared/splat.h"

namespace brume::methods::tiles {
namespace {

constexpr CostInfo kBin{"tile_bin", "bin", 870};    // particles
constexpr CostInfo kMedium{"tiles", "medium", 1.1}; // fragments, twice with two points
constexpr const CostInfo* kCosts[] = {&costs::kOrder, &kBin, &kMedium};

class Plan final : public MethodPlan {
public:
    const char* name() const override { return "tiles"; }
    const char* about() const override {
        return "compute tiles, the full Gaussian, light cached on particles or 2-point Gauss-Hermite";
    }
    uint32_t variant(const RenderSettings& s) const override { return isCached(s) + 2 * behindBalls(s); }
    uint32_t shaders(const RenderSettings& s) const override { return variant(s); } // also of the union's path
    std::string text(const RenderSettings& s) const override {
        return "tiles, " + s.tiles.quadrature + (behindBalls(s) ? " behind the union of balls" : "");
    }
    bool draws(std::string_view model) const override {
        return model == kSumMedium || model == kEllipsoidMedium || model == kUnionMedium;
    }
    uint64_t bytesPerParticle() const override { return sizeof(gpu::Splat) + sizeof(gpu::SplatCone); }
    std::span<const CostInfo* const> costs() const override { return kCosts; }

    // The laws of errors are those of a sum of Gaussians under light that is fitted to it.
    void addWays(const PlanScene& scene, const RenderSettings& wanted, bool asked, std::vector<RenderSettings>& ways,
                 std::string& refused) const override {
        if (!asked && (scene.features.balls || wanted.tiles.light == "path")) return;
        if (asked && behindBalls(wanted) && double(scene.capacity) > limits::kUnionCount.hi) {
            refused = fmt::format("tiles: light = \"path\" is for up to {} particles", int(limits::kUnionCount.hi));
            return;
        }
        if (asked) return ways.push_back(wanted);
        RenderSettings way = wanted;
        for (const char* quadrature : {"cached", "hermite"}) {
            way.tiles.quadrature = quadrature;
            ways.push_back(way);
        }
    }
    void addSharedWork(const PlanScene& scene, const RenderSettings& settings, Work& work) const override {
        if (behindBalls(settings))
            work[costs::kUnionPath] = scene.particles;
        else if (isCached(settings))
            work[costs::kParticleLight] = scene.particles;
    }
    void addViewWork(const ViewWork& view, const RenderSettings& settings, Work& work) const override {
        addDrawnWork(view, work);
        work[kBin] = view.scene().particles;
        work[kMedium] = view.fragments(1) * (isCached(settings) ? 1 : 2);
    }

private:
    bool behindBalls(const RenderSettings& settings) const {
        return isCached(settings) && settings.tiles.light == "path";
    }
    bool isCached(const RenderSettings& settings) const { return settings.tiles.quadrature == "cached"; }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::tiles
