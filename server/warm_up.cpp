#include "server/warm_up.h"

#include <algorithm>

#include "server/methods/plans.h"

namespace brume {
namespace {

// Shaders depend neither on a picture's size nor on a shadow map's. Small ones are drawn in a fraction of the time.
constexpr uint32_t kWidth = 64, kHeight = 36;
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
    draw(own_, settings, still);
    draw(inside_, settings, still);
    if (!coarse_ || settings.shading != kAuto || !planOf(settings.method)->hasRays()) return;
    RenderSettings shaded = settings;
    for (shaded.shading = 1; shaded.shading <= std::min(settings.rate, 8u); shaded.shading *= 2)
        draw(own_, shaded, still);
}

void WarmUp::draw(const PlanView& view, const RenderSettings& settings, bool still) {
    const EyeRequest eye{view.pose, std::min(view.width, kWidth), std::min(view.height, kHeight)};
    const RenderSettings shown = smallShadows(settings);
    submission_.probe.pixels.clear();
    if (probed_) submission_.probe.pixels = {glm::uvec2(0)};
    renderer_.submit(submission_, simulation_, {&eye, 1}, &shown, still);
    while (!submission_.commands.wait(1'000'000'000)) {
    }
}

} // namespace brume
