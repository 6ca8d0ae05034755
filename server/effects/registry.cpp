#include "server/effects/effect.h"

namespace brume {

#define BRUME_EFFECT(name)                                                                                             \
    namespace effects::name {                                                                                          \
    std::unique_ptr<Effect> make(const EffectContext& context);                                                        \
    }
#include "server/effects/list.h"
#undef BRUME_EFFECT

Effects makeEffects(const EffectContext& context) {
    Effects all;
#define BRUME_EFFECT(name) all.push_back(effects::name::make(context));
#include "server/effects/list.h"
#undef BRUME_EFFECT
    return all;
}

} // namespace brume
