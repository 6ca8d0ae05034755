// The opaque objects of a scene as the shaders want them. They do not move.
#pragma once

#include <vector>

#include "common/scene.h"
#include "shaders/shared/types.h"

namespace brume {

// Planes, boxes, spheres, in this order: what throws shadows on the medium comes last.
std::vector<gpu::Opaque> opaqueObjects(const Scene& scene);

} // namespace brume
