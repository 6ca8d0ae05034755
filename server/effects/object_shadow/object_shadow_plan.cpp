#include "server/effects/effect_plan.h"

namespace brume::effects::object_shadow {

// A frame seldom has its passes: the plan leaves them out.
const EffectPlan& plan() {
    static const EffectPlan kPlan;
    return kPlan;
}

} // namespace brume::effects::object_shadow
