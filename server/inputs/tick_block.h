// makeTick(): fills gpu::Tick, the uniform block that all viewers of a tick share. It has the light's axes and the
// bounds of both shadow maps, fitted to the scene.
#pragma once

#include <span>

#include "server/sim/simulation.h"

namespace brume {

// `particles`: the live ones; `objects`: opaqueObjects(). Light-space bounds hold every particle's support, so nothing
// outside them shadows.
gpu::Tick makeTick(const Scene& scene, const SceneNow& now, std::span<const gpu::Particle> particles,
                   std::span<const gpu::Opaque> objects);

} // namespace brume
