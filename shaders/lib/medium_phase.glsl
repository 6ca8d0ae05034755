// The medium's phase function.
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/phase.h"

// 1/sr. Directions are unit and along the photon's travel.
float mediumPhase(vec3 travel_in, vec3 travel_out) {
    const Phase p = tick.phase;
    return phaseOfLobes(travel_in, travel_out, p.part, p.asymmetry, p.draine, p.second);
}
