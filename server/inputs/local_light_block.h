// gpu::LocalLight: points and spots as the shaders want them.
#pragma once

#include <span>

#include "common/scene.h"
#include "server/medium/extent.h"
#include "shaders/shared/types.h"

namespace brume {

// Without a volume of the particles' depth.
gpu::LocalLight localLightBlock(const Light& light);
// Gives the light a volume of the particles' depth, for directions to the particles that it shines on. Returns the
// volume's size, in numbers. Directions and distances are as fine as the particles ask for, and coarser where all
// volumes would take too much work or memory. `before`: size of the volumes of other lights, which lie before it.
// `particles`: how many there are; `lights`: how many have a volume.
uint32_t setVolume(gpu::LocalLight& light, const MediumExtent& extent, uint32_t particles, uint32_t lights,
                   uint32_t before);

} // namespace brume
