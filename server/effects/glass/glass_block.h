// Sheets of glass as shaders read them, and how many of them an eye's picture needs layers for.
#pragma once

#include <span>

#include "common/camera.h"
#include "common/scene.h"
#include "shaders/shared/glass.h"

namespace brume {

gpu::GlassSheet glassSheet(const Glass& glass);

// Layers of medium besides the whole one that pictures of this eye are made of: one for each sheet that may be in it,
// at most gpu::kGlassLayers. `frustum`: frustumOf() the pose.
uint32_t glassLayers(std::span<const Glass> glasses, const Pose& pose, const Frustum& frustum);

} // namespace brume
