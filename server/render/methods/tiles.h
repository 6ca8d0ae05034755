// Compute tiles: splats of the whole Gaussian, gathered per tile near to far, several pixels a lane. Two quadratures: `cached`,
// light linear on every particle (light/particle_light.h), and `hermite`, two points with the shadow volume, as `sphere`.
#pragma once

#include "server/render/method.h"

namespace brume {
std::unique_ptr<Method> makeTiles(const MethodContext& context);
}
