// gpu::LocalLight: points and spots as the shaders want them.
#pragma once

#include <span>

#include "common/scene.h"
#include "server/medium/extent.h"
#include "shaders/shared/types.h"

namespace brume {

// Without a volume of the particles' depth.
gpu::LocalLight localLightBlock(const Light& light);
// Gives it the volume of that number, whose shells reach from one side of the particles to the other.
void setVolume(gpu::LocalLight& light, const MediumExtent& extent, uint32_t volume);

} // namespace brume
