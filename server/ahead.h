// Compiles ahead the shaders that a running server may need later. A driver compiles a shader when it is first used.
// A CPU driver takes up to seconds for it, and all viewers would wait.
#pragma once

#include <memory>

#include "common/process.h"
#include "server/gpu/device.h"
#include "server/plan/planner.h"

namespace brume {

// Draws pictures with the settings that more viewers or overload would lead to; nobody sees them. The driver caches
// the compiled shaders on disk for all processes of this user. Throws SceneError, gpu::Error.
void compileAhead(const Scene& scene, const gpu::Device& device, const CostModel& costs, double frame_budget_ms);

// Starts compileAhead() in a child process of lowest priority. `command`: the server's, for this scene. The process
// ends with the returned object. Null if it may need more memory than it is worth, or if no process can be started.
std::unique_ptr<Process> startAhead(const Scene& scene, std::vector<std::string> command);
// Lowers the priority (nice 19). The child process calls it first.
void stepBehind();

} // namespace brume
