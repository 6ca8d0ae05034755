// Where viewers stand who are within a place: for what they share when all of them see the same medium.
#pragma once

#include <vector>

#include "common/bounding_tree.h"
#include "common/camera.h"
#include "common/scene.h"
#include "server/sim/simulation.h"

namespace brume::bench {

inline constexpr double kEyeHeight = 1.7;  // m above the ground
inline constexpr double kStandingRoom = 1; // m between an eye and the nearest solid, at least

// m. Bounds of the scene's boxes, spheres and triangles; without any, of its particles.
Bounds3 placeBounds(const Scene& scene, const Bounds& particles);

// Eyes in the free space of those bounds, the same ones for the same scene: the first are the same for any count. They
// are at eye height where a plane lies in or below the bounds, else in the middle third of their height. Each looks
// level, along the longest way that is free within the bounds. Throws SceneError where there is no room for them.
std::vector<Pose> standInside(const Scene& scene, const Bounds& particles, uint32_t count);

} // namespace brume::bench
