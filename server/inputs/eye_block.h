// gpu::Eye: one eye as the shaders want it, and the coarse pictures that are drawn for it.
#pragma once

#include "common/scene.h"
#include "server/inputs/eye_request.h"
#include "shaders/shared/types.h"

namespace brume {

gpu::Eye eyeBlock(const EyeRequest& request, const RenderSettings& settings);
// How its rays run through the sun's volumetric shadow map.
gpu::MapRays mapRays(const gpu::Eye& eye, const gpu::LightMap& map);

// The same view drawn at every `step`-th of its pixels, from a step before its first on (shaders/lib/shaded.glsl).
EyeRequest everyStep(const EyeRequest& eye, uint32_t step);

// False if the eye is so far from the medium's bounds that its near plane meets no particle.
bool nearPlaneCuts(const gpu::Tick& tick, const EyeRequest& eye);

} // namespace brume
