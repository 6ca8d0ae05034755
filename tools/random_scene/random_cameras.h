// Cameras of random scenes.
#pragma once

#include <span>
#include <string>

#include "common/random.h"
#include "common/scene.h"

namespace brume {

std::span<const char* const> randomCameras(); // outside, inside, grazing, far

// Places the camera to see a medium of these points, which lie within about `radius` (m) of the origin. Returns its
// name.
std::string placeRandomCamera(SceneCamera& camera, std::span<const glm::vec3> points, float radius, Random& random);

} // namespace brume
