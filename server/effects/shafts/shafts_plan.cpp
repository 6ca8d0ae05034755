#include "server/effects/shafts/shafts_plan.h"

#include "server/effects/effect_plan.h"
#include "server/medium/band_limit.h"
#include "server/methods/plans.h"

namespace brume::effects::shafts {
namespace {

class Plan final : public EffectPlan {
public:
    Plan() : EffectPlan({&costs::kShafts}) {}

    void addViewWork(const ViewWork& view, const RenderSettings& settings, Work& work) const override {
        if (view.scene().features.casters && planOf(settings.method)->hasRays())
            work[costs::kShafts] = view.pixels() * (1 + view.shadowsMet()) * computed(view, settings);
    }
    // Of the pixels that are computed without soft edges.
    static double computed(const ViewWork& view, const RenderSettings& settings) {
        constexpr double kComputedSoft = 0.3;
        const bool coarse = pixelStep(settings.shading, settings.rate, view.scene().particles > 0) > 1;
        return coarse && settings.soft_edges ? kComputedSoft : 1;
    }
    uint64_t bytesOfPixel(const SceneFeatures& features) const override {
        return features.casters ? kShaftBytesOfPixel : 0;
    }
};

} // namespace

const EffectPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::effects::shafts
