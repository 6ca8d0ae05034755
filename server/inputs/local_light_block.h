// gpu::LocalLight: points and spots as the shaders want them.
#pragma once

#include <span>

#include "common/scene.h"
#include "shaders/shared/types.h"

namespace brume {

gpu::LocalLight localLightBlock(const Light& light);

} // namespace brume
