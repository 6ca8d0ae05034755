#include "server/effects/effect_plan.h"

namespace brume::effects::particle_fit {

// It runs apart from pictures, which the plan is of.
const EffectPlan& plan() {
    static const EffectPlan kPlan;
    return kPlan;
}

} // namespace brume::effects::particle_fit
