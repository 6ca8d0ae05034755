#include "server/effects/effect_plan.h"

namespace brume {

#define BRUME_EFFECT(name)                                                                                             \
    namespace effects::name {                                                                                          \
    const EffectPlan& plan();                                                                                          \
    }
#include "server/effects/list.h"
#undef BRUME_EFFECT

std::span<const EffectPlan* const> effectPlans() {
#define BRUME_EFFECT(name) &effects::name::plan(),
    static const EffectPlan* const kAll[] = {
#include "server/effects/list.h"
    };
#undef BRUME_EFFECT
    return kAll;
}

} // namespace brume
