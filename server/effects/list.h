// Every effect, one line each: BRUME_EFFECT(name) stands for the folder server/effects/name, which defines
//   const EffectPlan& brume::effects::name::plan()                               what it costs (name_plan.cpp)
//   std::unique_ptr<Effect> brume::effects::name::make(const EffectContext&)     what it does on the device
// Included where a table of them is made. An effect's passes may read what those above it have made.
BRUME_EFFECT(object_shadow)
BRUME_EFFECT(shadow_volume)
BRUME_EFFECT(union_path)
BRUME_EFFECT(propagation)
BRUME_EFFECT(particle_light)
BRUME_EFFECT(particle_fit)
BRUME_EFFECT(shafts)
BRUME_EFFECT(local_lights)
BRUME_EFFECT(glass)
