#include "server/effects/particle_light/particle_light_plan.h"

#include "server/effects/effect_plan.h"

namespace brume::effects::particle_light {

const EffectPlan& plan() {
    static const EffectPlan kPlan({&costs::kParticleLight});
    return kPlan;
}

} // namespace brume::effects::particle_light
