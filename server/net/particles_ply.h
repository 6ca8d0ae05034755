// Particles as a PLY file that layout `file` reads back (docs/scenes.md).
#pragma once

#include <string>

#include "server/viewer/particle_requests.h"

namespace brume::net {

// Binary, little-endian: x y z scale sigma_t red green blue id. Places are in the world, as doubles where the scene has
// an origin. Sizes are for a medium.falloff of 1.6, the default.
std::string particlesPly(const TakenParticles& taken);

} // namespace brume::net
