#include "server/effects/union_path/union_path_plan.h"

#include "server/effects/effect_plan.h"

namespace brume::effects::union_path {

const EffectPlan& plan() {
    static const EffectPlan kPlan({&costs::kUnionPath});
    return kPlan;
}

} // namespace brume::effects::union_path
