// setMultiple(): the part of gpu::Tick that describes light which scatters more than once.
#pragma once

#include <span>

#include "server/sim/simulation.h"
#include "shaders/shared/types.h"

namespace brume {

// Fluxes have the mean albedo of the particles, by extinction and volume. A union medium, none, and
// one without sunlight have single scattering. Precondition: the tick has the sun.
void setMultiple(gpu::Tick& tick, const SceneNow& now, std::span<const gpu::Particle> particles);

} // namespace brume
