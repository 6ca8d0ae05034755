// makeTick(): fills gpu::Tick, the uniform block that all viewers of a tick share. It has the light's axes and the
// bounds of both shadow maps, fitted to the scene.
#pragma once

#include <span>
#include <vector>

#include "server/inputs/scene_features.h"
#include "shaders/shared/types.h"

namespace brume {

// `particles`: the live ones; `objects`: opaqueObjects(). Light-space bounds hold every particle's support, so nothing
// outside them shadows.
// `balls`: the same particles as laws of errors take them, ballsOf() ellipsoids; empty: `particles` are balls.
gpu::Tick makeTick(const Scene& scene, const SceneNow& now, std::span<const gpu::Particle> particles,
                   std::span<const gpu::Opaque> objects, std::span<const gpu::Particle> balls = {});

// Balls that bend as much at their middles as the ellipsoids do on average, with the same mass, into `out`. Nothing for
// no axes.
void ballsOf(std::span<const gpu::Particle> particles, std::span<const gpu::EllipsoidAxes> axes,
             std::vector<gpu::Particle>& out);

// Sets the sun's direction, and the axes of light space by it.
void setSun(gpu::Tick& tick, glm::vec3 to_light);

// False: there is one fog without a ball, and nothing else. Pixels have its light in closed form (isFogOnly() of
// shaders/lib/fog.glsl), and nothing reads what rays hold.
inline bool needsRays(const gpu::Tick& tick) {
    return tick.particle_count > 0 || tick.fog_count != 1 || tick.fogs[0].radius < kNoBall;
}

} // namespace brume
