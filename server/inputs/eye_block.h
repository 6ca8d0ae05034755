// gpu::Eye: one eye as the shaders want it, and the coarse pictures that are drawn for it.
#pragma once

#include "common/scene.h"
#include "server/inputs/eye_request.h"
#include "shaders/shared/types.h"

namespace brume {

gpu::Eye eyeBlock(const EyeRequest& request, const RenderSettings& settings);
// Coefficients of the eye's rays in coordinates of the volumetric shadow map.
gpu::MapRays mapRays(const gpu::Eye& eye, const gpu::LightMap& map);

// The request for every `step`-th pixel of `eye`, with one more row above and one more column to the left
// (shaders/lib/shaded.glsl).
EyeRequest everyStep(const EyeRequest& eye, uint32_t step);

// True if the eye's near plane may cut a particle: the eye is inside the medium's bounds or close to them.
bool nearPlaneCuts(const gpu::Tick& tick, const EyeRequest& eye);

} // namespace brume
