#include "server/effects/propagation/propagation_plan.h"

#include <algorithm>
#include <cmath>

#include "server/effects/effect_plan.h"
#include "server/effects/propagation/flux_sizes.h"
#include "server/inputs/multiple_block.h"
#include "server/inputs/objects.h"

namespace brume {

uint64_t propagationMemory(const gpu::Tick& tick, const PropagationSettings& settings, bool one_albedo, uint32_t hues) {
    const gpu::Multiple& multiple = tick.multiple;
    if (multiple.cells == 0) return 0;
    const FluxSizes sizes =
        fluxSizes(multiple.cells, multiple.channels, hasCellMatter(tick, one_albedo), lightsSurfaces(tick, settings));
    return hues * sizes.ofHue() + sizes.matter;
}

namespace effects::propagation {
namespace {

class Plan final : public EffectPlan {
public:
    Plan() : EffectPlan({&costs::kPropagation}) {}

    void addSharedWork(const PlanScene& scene, const RenderSettings& settings, Work& work) const override {
        const gpu::Multiple& multiple = scene.tick.multiple;
        if (multiple.cells == 0) return;
        const double cells = std::pow(multiple.cells, 3.0);
        // The next grids have 1/8 and 1/64 of the cells, and 2 and 4 times the steps.
        work[costs::kPropagation] =
            double(scene.hues) * multiple.channels * cells * settings.propagation.iterations * (1 + 2.0 / 8 + 4.0 / 64);
        // A part of a surface, whatever the channels, takes half as long as a step of a cell. Cells of the second grid,
        // an eighth, have them; of a box one and a half faces are seen and lit, by and large.
        const uint32_t planes = scene.tick.plane_count, bodies = scene.tick.opaque_count - planes;
        const double surfaces = (planes > 0 ? 1 : 0) + 1.5 * std::min(bodies, kMostReflecting);
        work[costs::kPropagation] +=
            0.5 * scene.hues * cells / 8 * std::pow(settings.propagation.surface_parts, 2.0) * surfaces;
    }
};

} // namespace

const EffectPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace effects::propagation
} // namespace brume
