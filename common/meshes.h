// The triangles of a scene's meshes.
#pragma once

#include <vector>

#include "common/scene.h"

namespace brume {

// Those of all meshes, one mesh after the other; triangles without an area are left out. Says in lines what of a
// file is not read. Throws SceneError for a file that is wrong, or reaches too far from the origin.
std::vector<Triangle> trianglesOf(const std::vector<Mesh>& meshes);

} // namespace brume
