#include "server/effects/glass/glass_plan.h"

#include "server/effects/effect_plan.h"
#include "server/effects/glass/glass_block.h"
#include "server/effects/local_lights/local_lights_plan.h"
#include "server/effects/shafts/shafts_plan.h"
#include "server/methods/plans.h"

namespace brume::effects::glass {
namespace {

class Plan final : public EffectPlan {
public:
    Plan() : EffectPlan({&costs::kGlass}) {}

    // What the layers between sheets take: passes of the medium that run again for each. Methods with rays make their
    // field once, and it is looked up for each layer. Others draw the medium again: at most all of it, since a layer
    // ends at its sheet.
    void addViewWork(const ViewWork& view, const RenderSettings& settings, Work& work) const override {
        if (!view.scene().features.glass) return;
        const std::vector<Glass>& glasses = view.scene().glasses;
        const PlanView& of = view.view();
        const uint32_t layers = glassLayers(glasses, of.pose, frustumOf(of.pose, of.width, of.height));
        const bool has_rays = planOf(settings.method)->hasRays();
        Work layer = work;
        for (const CostInfo* cost : allCosts()) {
            const std::string_view pass = cost->pass;
            const bool of_field = pass == "compose" || cost == &costs::kShafts || cost == &costs::kLocalLight,
                       once = pass == "opaque" || pass == "cull, sort" || pass == "compose";
            if (has_rays ? !of_field : once) layer[*cost] = 0;
        }
        layer *= layers;
        work += layer;
        if (has_rays) work[costs::kCompose] += view.pixels(); // a field's picture
        if (layers > 0) work[costs::kGlass] += view.pixels() * (1 + layers) * (1 + double(glasses.size()));
    }
    uint64_t bytesOfPixel(const SceneFeatures& features) const override {
        return features.glass ? kGlassBytesOfPixel : 0;
    }
};

} // namespace

const EffectPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::effects::glass
