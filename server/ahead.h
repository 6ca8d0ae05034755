// Shaders that a running server may come to need, compiled before it does: a driver compiles what is drawn for the first time,
// which takes a CPU driver up to seconds, for which all viewers would wait.
#pragma once

#include <memory>

#include "common/process.h"
#include "server/gpu/device.h"
#include "server/plan/planner.h"

namespace brume {

// Draws, unseen, what other viewers and overload lead to. The driver keeps what it compiled on disk, for every process of this
// user. Throws SceneError, gpu::Error.
void compileAhead(const Scene& scene, const gpu::Device& device, const CostModel& costs, double frame_budget_ms);

// The same by another process with these arguments, of the least priority, which ends with this object. Null where that may take
// more memory than it is worth, and when no process can be started.
std::unique_ptr<Process> startAhead(const Scene& scene, int argc, const char* const* argv);
// To be called by that process, first.
void stepBehind();

} // namespace brume
