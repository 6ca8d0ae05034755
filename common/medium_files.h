// What a medium's file holds beside particles. A file that is still in use is not read again while it is the same.
#pragma once

#include <memory>

#include "common/scene.h"

namespace brume {

// Null with another model. `origin`: the scene's. Throws SceneError if the file is bad, as below.
std::shared_ptr<const Tetrahedra> tetrahedraOf(const Medium& medium, const glm::dvec3& origin);
// Null with another layout.
std::shared_ptr<const Volume> volumeOf(const Medium& medium, const glm::dvec3& origin);

} // namespace brume
