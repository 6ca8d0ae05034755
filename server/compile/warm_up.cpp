#include "server/compile/warm_up.h"

#include <algorithm>

#include "server/methods/plans.h"

namespace brume {
namespace {

// Shaders depend neither on a picture's size nor on a shadow map's. Small ones are drawn in a fraction of the time.
constexpr uint32_t kWidth = 64, kHeight = 36;
constexpr uint64_t kHistory = uint64_t(1) << 48; // EyeRequest::history of no viewer
constexpr uint32_t kShadowSize = 32, kShadowSlices = 17;

RenderSettings smallShadows(RenderSettings settings) {
    settings.shadow_size = kShadowSize;
    settings.shadow_slices = kShadowSlices;
    return settings;
}

} // namespace

WarmUp::WarmUp(Renderer& renderer, Submission& submission, const Scene& scene, const Simulation& simulation,
               bool probed)
    : renderer_(renderer), submission_(submission), simulation_(simulation), own_(ownView(scene)), inside_(own_),
      probed_(probed), coarse_(!featuresOf(scene, simulation.now()).opaque) {
    const MediumExtent extent = planScene(scene, simulation).extent;
    inside_.pose.position = 0.5f * (extent.lo + extent.hi);
}

void WarmUp::drawForEveryCamera(const RenderSettings& settings, bool still) {
    draw(own_, settings, still, {.history = kHistory});
    draw(inside_, settings, still);
    if (!coarse_ || settings.shading != kAuto || !planOf(settings.method)->hasRays()) return;
    RenderSettings shaded = settings;
    for (shaded.shading = 1; shaded.shading <= std::min(settings.rate, 8u); shaded.shading *= 2)
        draw(own_, shaded, still);
}

void WarmUp::drawLayers(const RenderSettings& settings) { draw(own_, settings, false, {.depth_layers = 1}); }

void WarmUp::drawViews(const RenderSettings& settings, bool still) {
    for (uint32_t show = gpu::kShowPicture + 1; show < gpu::kShows; ++show) draw(own_, settings, still, {.show = show});
}

void WarmUp::draw(const PlanView& view, const RenderSettings& settings, bool still, EyeRequest eye) {
    eye.pose = view.pose;
    eye.width = std::min(view.width, kWidth), eye.height = std::min(view.height, kHeight);
    const RenderSettings shown = smallShadows(settings);
    submission_.probe.pixels.clear();
    if (probed_) submission_.probe.pixels = {glm::uvec2(0)};
    renderer_.submit(submission_, simulation_, {&eye, 1}, &shown, still);
    while (!submission_.commands.wait(1'000'000'000)) {
    }
}

} // namespace brume
