// What viewers and operators are told of the scene.
#pragma once

#include <memory>

#include "server/plan/plan.h"
#include "server/sim/simulation.h"
#include "server/viewer/audience.h"

namespace brume {

// The scene and the plan as they are now; passes and memory are left to the caller.
std::shared_ptr<SceneReport> sceneReport(const Simulation& simulation, const Plan& plan);

// Relative RMSE that pictures may have with these settings: render.error. 0: nothing is promised, since the scene names
// the method.
double promisedError(const RenderSettings& wanted);

// Viewers are told that the scene is paused, or not, whatever the simulation says. `changes`: how often that changed.
void tellPaused(SceneReport& report, bool paused, uint64_t changes);

} // namespace brume
