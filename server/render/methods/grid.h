// Slabs along a coarse grid of rays, sampled from a grid of the medium in world space that is made once per tick for all viewers:
// what a viewer costs does not depend on the number of particles.
#pragma once

#include "server/render/method.h"

namespace brume {
std::unique_ptr<Method> makeGrid(const MethodContext& context);
}
