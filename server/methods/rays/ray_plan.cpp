#include "server/methods/rays/ray_plan.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>

#include <fmt/format.h>

#include "server/medium/band_limit.h"

namespace brume {
namespace {

constexpr uint32_t kSlabCounts[] = {8, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512};
constexpr uint32_t kMostFinerSlabs = 512;
constexpr double kLeastError = 2e-4; // remains however fine rays and slabs are: float32 and the cut-off
// Least deviation of a particle, in slabs (slab_bins.comp), and the thickness in deviations above which it is widened.
constexpr double kWidened = 0.7, kSlabsWiden = 1 / kWidened;

// RMSE of a ball or layer that fills a part of the picture, at its edges, per rate and pixels along the picture's side:
// 0.4 to 0.53 for dense balls before a bright sky.
constexpr double kFogEdges = 0.5;
// RMSE of lamps' light between rays that are as far apart as the length in which it varies; cubes of less.
constexpr double kLampsError = 0.02;
// RMSE of soft edges: 0.15 to 0.77 % in seven shipped scenes.
constexpr double kSoftEdgesError = 0.004;

double square(double x) { return x * x; }

} // namespace

double rayError(double spacing) {
    const double e = 0.001 * spacing + 0.0225 * std::pow(spacing, 6.6);
    return e / (1 + e / 0.6);
}

double slabError(double thickness, double bend, double light_depth) {
    const double c = 0.003 * bend * (1 + 0.3 * light_depth), most = kSlabsWiden;
    const double e =
        thickness < most ? c * std::pow(thickness, 4) : 2.2 * c * std::pow(most, 4) * square(thickness / most);
    return e / (1 + e);
}

double widenedError(double thickness, double oblique) {
    const double smeared = std::max(square(thickness / kSlabsWiden) - 1, 0.0) * oblique;
    return 0.35 * smeared / (1 + 0.8 * smeared);
}

double displacedError(double thickness, double deviation, double extinction) {
    const double along = square(thickness * kWidened) - square(deviation);
    const double e = std::max(along, 0.0) * square(extinction);
    return e / (1 + e);
}

double endsError(double thickness, uint32_t slabs) {
    return std::clamp(square(thickness / kSlabsWiden) - 1, 0.0, 1.0) * 0.15 / slabs;
}

double sampledError(double thickness) {
    return std::min(std::numbers::sqrt2 * std::exp(-2 * square(std::numbers::pi / thickness)), 1.0);
}

double cutError(double thickness, double light_depth) {
    const double e = (0.035 + 0.1 * light_depth) * std::pow(std::min(thickness, 1.5), 4);
    return e / (1 + e);
}

double raysError(const ViewWork& view, uint32_t rate) {
    if (rate <= 1) return 0; // every pixel has its ray
    double sum = 0;
    for (const SeenLight::Size& size : view.light().sizes()) sum += size.part * square(rayError(rate / size.projected));
    return std::sqrt(sum);
}

double fogError(const ViewWork& view, uint32_t rate) {
    const gpu::Tick& tick = view.scene().tick;
    const float height = view.eye().y; // a layer has an edge for eyes above and below it
    const auto has_edge = [&](const gpu::Fog& fog) {
        return fog.radius < kNoBall || height < fog.lo || height > fog.hi;
    };
    const bool edges = std::any_of(tick.fogs, tick.fogs + tick.fog_count, has_edge);
    return edges && rate > 1 ? kFogEdges * rate / std::sqrt(view.pixels()) : 0;
}

double slabsError(const ViewWork& view, uint32_t slabs, bool widened) {
    const double thickness = (view.far() - view.near()) / slabs, light = view.light().lightDepth();
    double sum = 0, displaced = 0;
    for (const SeenLight::Size& size : view.light().sizes()) {
        const double h = thickness / size.deviation;
        if (widened)
            displaced +=
                size.light * (displacedError(thickness, size.deviation, size.extinction) + endsError(h, slabs));
        const double along = widened ? std::max(kWidened * h, 1.0) : 1; // deviations of a particle on the view axis
        const double sampled = sampledError(h * std::sqrt(1 / square(along) + size.oblique));
        const double wide = widened ? widenedError(h, size.oblique) : 0;
        sum += size.part * (square(slabError(h, size.bend, light)) + square(wide) + square(sampled)) +
               size.cut * square(cutError(h, light));
    }
    return std::hypot(std::sqrt(sum), displaced);
}

double lightingError(const ViewWork& view, const RenderSettings& settings) {
    const PlanScene& scene = view.scene();
    const auto smooth = [](const gpu::LocalLight& light) { return light.smooth_length > 0; };
    const bool lamps = std::ranges::any_of(scene.local_lights, smooth);
    const bool edges = scene.features.casters || std::ranges::any_of(scene.local_lights, std::not_fn(smooth));
    return std::hypot(lamps ? kLampsError * std::pow(double(settings.lamp_spacing), 3) : 0,
                      edges && settings.soft_edges ? kSoftEdgesError : 0);
}

std::optional<double> RayPlan::error(const RenderSettings& settings, const ViewWork& view) const {
    const double across = std::hypot(raysError(view, settings.rate), fogError(view, settings.rate));
    return std::hypot(std::hypot(kLeastError, nodeError(settings, view), lightingError(view, settings)), across,
                      slabsError(view, settings.slabs, widens()));
}

std::optional<RenderSettings> RayPlan::coarser(const RenderSettings& settings, Coarser direction) const {
    RenderSettings next = settings;
    if (direction == Coarser::light) {
        if (settings.lamp_spacing != kAuto && settings.lamp_spacing < kCoarseLamps)
            next.lamp_spacing = kCoarseLamps;
        else if (!settings.soft_edges)
            next.soft_edges = true;
        else
            return {};
    } else if (direction == Coarser::along) {
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
    next.lamp_spacing = std::min(next.lamp_spacing, kFineLamps);
    next.soft_edges = false;
    return next;
}

std::string RayPlan::raysText(const RenderSettings& settings) {
    return fmt::format("a ray per {0}x{0} pixels, {1} slabs{2}{3}", settings.rate, settings.slabs,
                       settings.lamp_spacing >= kCoarseLamps ? ", lamps on rays" : "",
                       settings.soft_edges ? ", soft edges" : "");
}

void RayPlan::addRays(const PlanScene& scene, RenderSettings way, std::vector<RenderSettings>& ways) {
    if (!scene.needsRays()) {
        if (!way.rate) way.rate = kUnreadRate;
        if (!way.slabs) way.slabs = kUnreadSlabs;
    }
    if (way.lamp_spacing == kAuto) way.lamp_spacing = kFineLamps;
    const uint32_t wanted_rate = way.rate, wanted_slabs = way.slabs;
    for (const uint32_t rate : kRates)
        for (const uint32_t slabs : kSlabCounts) {
            way.rate = wanted_rate ? wanted_rate : rate;
            way.slabs = wanted_slabs ? wanted_slabs : slabs;
            const bool repeated = (wanted_rate && rate != kRates[0]) || (wanted_slabs && slabs != kSlabCounts[0]);
            if (!repeated) ways.push_back(way);
        }
}

void RayPlan::addDisplayWork(const ViewWork& view, const RenderSettings& settings, Work& work) {
    const PlanScene& scene = view.scene();
    if (scene.features.opaque) {
        work[costs::kOpaque] = view.pixels() * (1 + scene.objects);
        work[costs::kRayEnds] = scene.needsRays() || scene.features.casters ? view.pixels() : 0;
    }
    const double lobe = scene.features.lobe ? scene.lobe_width / view.pixel() : 1e30;
    const uint32_t step =
        scene.features.opaque ? 1 : shadingStep(settings, settings.rate, float(1 / view.raySpacing(1)), float(lobe));
    if (step > 1) {
        work[costs::kShade] = (groupsOf(view.width(), step) + 3) * (groupsOf(view.height(), step) + 3);
        work[costs::kPresent] = view.pixels();
    } else {
        work[costs::kComposeField] = view.pixels() * (1 + (scene.features.opaque ? 1 : 0));
    }
}

glm::dvec2 RayPlan::raysOf(const ViewWork& view, const RenderSettings& settings) {
    return glm::dvec2(groupsOf(view.width(), settings.rate), groupsOf(view.height(), settings.rate)) +
           double(raysBeyond(kRayMargin));
}

} // namespace brume
