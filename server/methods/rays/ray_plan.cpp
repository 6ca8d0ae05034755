#include "server/methods/rays/ray_plan.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/medium/band_limit.h"

namespace brume {
namespace {

constexpr uint32_t kSlabCounts[] = {8, 16, 24, 32, 48, 64, 96, 128, 192, 256};
constexpr uint32_t kMostFinerSlabs = 512;
constexpr double kLeastError = 2e-4; // remains however fine rays and slabs are: float32 and the cut-off

} // namespace

double rayError(double spacing) { return 0.0055 * std::pow(spacing, 4.5); }

// Within a slab light and extinction vary together to second order in its thickness: by the depth that a slab has, up
// to where what lies behind is hidden. The eye that is in the medium sees each slab by itself; from outside the rim,
// where little is scattered, counts too. Above 1.43 slabs widen the particles: from there on the error grows as the
// fourth power.
double slabError(double thickness, double depth, bool inside) {
    const double curvature = inside ? std::min(0.065 * depth, 0.0145) : std::min(0.06 * depth, 0.0085);
    return curvature * thickness * thickness * (1 + std::pow(thickness / 2, 4));
}

std::optional<double> RayPlan::error(const RenderSettings& settings, const ViewWork& view) const {
    return std::hypot(std::hypot(kLeastError, nodeError(settings)), rayError(view.raySpacing(settings.rate)),
                      slabError(view.slabThickness(settings.slabs), view.deviationDepth(), view.inside()));
}

std::optional<RenderSettings> RayPlan::coarser(const RenderSettings& settings, Coarser direction) const {
    RenderSettings next = settings;
    if (direction == Coarser::along) {
        if (settings.slabs <= kSlabCounts[0]) return {};
        for (const uint32_t fewer : kSlabCounts)
            if (fewer < settings.slabs) next.slabs = fewer;
    } else {
        if (settings.rate >= std::end(kRates)[-1]) return {};
        next.rate = *std::upper_bound(std::begin(kRates), std::end(kRates), settings.rate);
    }
    return next;
}

RenderSettings RayPlan::finer(const RenderSettings& settings) const {
    RenderSettings next = settings;
    if (next.rate > 1) next.rate /= 2;
    next.slabs = std::min(2 * next.slabs, kMostFinerSlabs);
    return next;
}

void RayPlan::addRays(RenderSettings way, std::vector<RenderSettings>& ways) {
    const uint32_t wanted_rate = way.rate, wanted_slabs = way.slabs;
    for (const uint32_t rate : kRates)
        for (const uint32_t slabs : kSlabCounts) {
            way.rate = wanted_rate ? wanted_rate : rate;
            way.slabs = wanted_slabs ? wanted_slabs : slabs;
            const bool again = (wanted_rate && rate != kRates[0]) || (wanted_slabs && slabs != kSlabCounts[0]);
            if (!again) ways.push_back(way);
        }
}

void RayPlan::addDisplayWork(const ViewWork& view, const RenderSettings& settings, Work& work) {
    const PlanScene& scene = view.scene();
    if (scene.features.opaque) {
        work[costs::kOpaque] = view.pixels() * (1 + scene.objects);
        work[costs::kRayEnds] = view.pixels();
    }
    const double lobe = scene.features.lobe ? (1 - std::abs(double(scene.tick.asymmetry))) / view.pixel() : 1e30;
    const uint32_t step =
        scene.features.opaque ? 1 : shadingStep(settings, settings.rate, float(1 / view.raySpacing(1)), float(lobe));
    if (step > 1) {
        work[costs::kShade] = (groupsOf(view.width(), step) + 3) * (groupsOf(view.height(), step) + 3);
        work[costs::kPresent] = view.pixels();
    } else {
        work[costs::kComposeField] = view.pixels() * (1 + (scene.features.opaque ? 1 : 0) + scene.casters);
    }
}

glm::dvec2 RayPlan::raysOf(const ViewWork& view, const RenderSettings& settings) {
    return glm::dvec2(groupsOf(view.width(), settings.rate), groupsOf(view.height(), settings.rate)) +
           double(raysBeyond(kRayMargin));
}

} // namespace brume
