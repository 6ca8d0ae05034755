#include "server/effects/local_lights/local_lights_plan.h"

#include <algorithm>

#include "server/effects/effect_plan.h"
#include "server/inputs/local_light_block.h"
#include "server/medium/band_limit.h"
#include "server/methods/plans.h"
#include "shaders/shared/lamps.h"

namespace brume {

namespace {

bool isOnRays(const gpu::LocalLight& light, const ViewWork& view, const RenderSettings& settings) {
    const auto slab = float((view.far() - view.near()) / std::max(settings.slabs, 1u));
    return physics::raysHold(light.smooth_length, float(view.viewDepth(light.position)),
                             float(settings.rate * view.pixel()), slab, settings.lamp_spacing);
}

} // namespace

double localPieces(const ViewWork& view, const RenderSettings& settings) {
    // Part of the pixels that are computed, and with soft edges; neighbours tell the others.
    constexpr double kComputed = 0.25, kComputedSoft = 0.12;
    constexpr double kPiecesWithoutSlabs = 6; // pieces of a ray in a light's range, where there are no slabs
    const PlanScene& scene = view.scene();
    const bool particles = scene.particles > 0;
    const bool coarse = pixelStep(settings.shading, settings.rate, particles) > 1;
    double lit = 0;
    for (size_t i = 0; i < scene.local_lights.size(); ++i)
        if (!isOnRays(scene.local_lights[i], view, settings)) lit += view.litPixelsOf()[i];
    const double computed = !coarse ? 1 : settings.soft_edges ? kComputedSoft : kComputed;
    return lit * computed * (kPiecesWithoutSlabs + (particles ? settings.slabs : 0));
}

double lampsOnRays(const ViewWork& view, const RenderSettings& settings) {
    constexpr double kFilled = 0.5; // part of the slabs that have medium, in the box around it
    const PlanScene& scene = view.scene();
    double lit = 0;
    for (size_t i = 0; i < scene.local_lights.size(); ++i)
        if (isOnRays(scene.local_lights[i], view, settings))
            lit += std::min(view.litPixelsOf()[i], view.mediumPixels());
    return lit / (double(settings.rate) * settings.rate) * settings.slabs * kFilled;
}

namespace effects::local_lights {
namespace {

class Plan final : public EffectPlan {
public:
    Plan() : EffectPlan({&costs::kLocalLightDepth, &costs::kLocalLight, &costs::kLitSurfaces}) {}

    void addSharedWork(const PlanScene& scene, const RenderSettings& settings, Work& work) const override {
        if (scene.particles == 0) return;
        const auto shadows = [](const gpu::LocalLight& light) { return light.shadows != 0; };
        const auto lights = uint32_t(std::ranges::count_if(scene.local_lights, shadows));
        double directions = 0;
        for (gpu::LocalLight light : scene.local_lights) {
            if (!shadows(light)) continue;
            setVolume(light, scene.extent, scene.particles, lights, 0, hasCoarseVolumes(settings));
            directions += double(light.volume_side) * light.volume_side;
        }
        work[costs::kLocalLightDepth] = directions * scene.particles;
    }
    void addViewWork(const ViewWork& view, const RenderSettings& settings, Work& work) const override {
        const PlanScene& scene = view.scene();
        if (!scene.features.opaque || !planOf(settings.method)->hasRays()) return;
        work[costs::kLitSurfaces] = view.litPixels() * (1 + scene.objects);
        work[costs::kLocalLight] = localPieces(view, settings);
    }
    uint64_t bytesOfPixel(const SceneFeatures& features) const override {
        return features.local_lights ? kLitBytesOfPixel : 0;
    }
    uint64_t mostBytesOfPixel(const SceneFeatures& features) const override {
        constexpr uint64_t kBins = 1; // 256 pixels share a bin of at most 32 words
        return features.local_lights ? kLitBytesOfPixel + kBins : 0;
    }
};

} // namespace

const EffectPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace effects::local_lights
} // namespace brume
