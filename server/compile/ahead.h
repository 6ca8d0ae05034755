// Compiles ahead the shaders that a running server may need later. A driver compiles a shader when it is first used.
// A CPU driver takes up to seconds for it, and all viewers would wait.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/process.h"
#include "server/compile/compiled_ways.h"
#include "server/gpu/device.h"
#include "server/plan/planner.h"

namespace brume {

// A line on a way that is compiled begins so; then comes text(WayShaders). Before it come those
// with the texts of its pipelines.
inline constexpr std::string_view kCompiled = "compiled ", kPipeline = "pipeline ";

// Draws pictures with the settings that other cameras, more viewers or overload would lead to; nobody sees them. The
// driver caches the compiled shaders on disk for all processes of this user. Writes a line on each way to `out`.
// Throws SceneError, gpu::Error.
void compileAhead(const Scene& scene, const gpu::Device& device, const CostModel& costs, double frame_budget_ms,
                  std::ostream& out);

// Draws small pictures by the way of scene.render, so that its pipelines are in this process. May be called beside the
// frame loop of the same device. `way`: whether of still pictures, and of layers. Throws SceneError,
// gpu::Error.
void makePipelines(const Scene& scene, const gpu::Device& device, const WayShaders& way);

// False: a second process with the scene may need more memory than it is worth.
bool isWorthCompiling(const Scene& scene);
// Starts compileAhead() in a child process, soon of low priority. `command`: the server's, for this scene.
// `overrides`: as for --set. `on_line` is called on another thread when it has compiled something. The process ends
// with the returned object. Null if no process can be started.
std::unique_ptr<Process> startAhead(std::vector<std::string> command, std::span<const std::string> overrides,
                                    std::function<void()> on_line);

} // namespace brume
