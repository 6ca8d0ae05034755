#include "server/effects/local_lights/local_lights_plan.h"

#include <algorithm>

#include "server/effects/effect_plan.h"
#include "server/inputs/local_light_block.h"
#include "server/medium/band_limit.h"
#include "server/methods/plans.h"

namespace brume {

double localPieces(const ViewWork& view, const RenderSettings& settings) {
    constexpr double kComputed = 0.25;        // part of the pixels that are computed; neighbours tell the others
    constexpr double kPiecesWithoutSlabs = 6; // pieces of a ray in a light's range, where there are no slabs
    const bool particles = view.scene().particles > 0;
    const bool coarse = pixelStep(settings.shading, settings.rate, particles) > 1;
    return view.litPixels() * (coarse ? kComputed : 1) * (kPiecesWithoutSlabs + (particles ? settings.slabs : 0));
}

namespace effects::local_lights {
namespace {

class Plan final : public EffectPlan {
public:
    Plan() : EffectPlan({&costs::kLocalLightDepth, &costs::kLocalLight, &costs::kLitSurfaces}) {}

    void addSharedWork(const PlanScene& scene, const RenderSettings& /*settings*/, Work& work) const override {
        if (scene.particles == 0) return;
        const auto shadows = [](const gpu::LocalLight& light) { return light.shadows != 0; };
        const auto lights = uint32_t(std::ranges::count_if(scene.local_lights, shadows));
        double directions = 0;
        for (gpu::LocalLight light : scene.local_lights) {
            if (!shadows(light)) continue;
            setVolume(light, scene.extent, scene.particles, lights, 0);
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
