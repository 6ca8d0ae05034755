// What all viewers share in one tick, as the shaders want it: the light's axes and the bounds of both shadow maps fitted to the
// scene.
#pragma once

#include <span>
#include <vector>

#include "server/sim/simulation.h"

namespace brume {

// The opaque objects of a scene: planes, boxes, spheres, in this order.
std::vector<gpu::Opaque> opaqueObjects(const Scene& scene);

// `particles` are the live ones. Light-space bounds hold every particle's support, so nothing shadows from outside them.
gpu::Tick makeTick(const Scene& scene, const SceneNow& now, std::span<const gpu::Particle> particles,
                   std::span<const gpu::Opaque> objects);

} // namespace brume
