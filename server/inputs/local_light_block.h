// gpu::LocalLight: points and spots as the shaders want them.
#pragma once

#include <span>

#include "common/scene.h"
#include "server/medium/extent.h"
#include "shaders/shared/types.h"

namespace brume {

// Without a volume of the particles' depth.
gpu::LocalLight localLightBlock(const Light& light);
// Gives it a volume of the particles' depth that begins after `before` numbers of others. Returns how many it has. Its
// directions are those to the particles that the light shines on. They and its distances are as fine as the particles
// ask for, within bounds by the work and the size of all volumes. `particles`: how many; `lights`: those with a volume.
uint32_t setVolume(gpu::LocalLight& light, const MediumExtent& extent, uint32_t particles, uint32_t lights,
                   uint32_t before);

} // namespace brume
