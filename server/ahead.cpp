#include "server/ahead.h"

#include <system_error>
#include <utility>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "server/render/renderer.h"
#include "server/sim/sequence_files.h"

namespace brume {
namespace {

constexpr uint32_t kMostParticles = 100'000;                   // those of a second process take as much memory again
constexpr uint32_t kHeights[] = {90, 180, 270, 360, 540, 720}; // pixels; widths in 16:9
constexpr uint32_t kMostSteps = 12;                            // of overload

} // namespace

void compileAhead(const Scene& scene, const gpu::Device& device, const CostModel& costs, double frame_budget_ms) {
    const Simulation simulation(standIn(scene));
    Renderer renderer(device, scene, simulation.capacity());
    Submission submission(device, "ahead");
    Planner planner(scene, costs, frame_budget_ms);
    const PlanView own = ownView(scene);
    const RenderSettings planned = planner.settings(simulation, {&own, 1}, true, Planner::Time::clock::now());
    const auto drawAt = [&](const PlanView& view, uint32_t rate, const RenderSettings& settings, bool rests) {
        const EyeRequest eye{view.pose, view.width, view.height, false, rate};
        renderer.submit(submission, simulation, {&eye, 1}, &settings, rests);
        while (!submission.commands.wait(1'000'000'000)) {
        }
    };
    const auto draw = [&](const PlanView& view, const RenderSettings& settings, bool rests) {
        drawAt(view, planner.rateOf(view, settings), settings, rests);
    };
    // Viewers near and far, with large and small pictures, that move and that rest.
    for (const uint32_t height : kHeights) {
        const PlanView view{own.pose, height * 16 / 9, height};
        draw(view, planned, false);
        draw(view, finer(planned), true);
        drawAt(view, 0, planner.once(simulation, view).settings, true); // snapshots
    }
    std::optional<RenderSettings> coarser = planned;
    for (uint32_t step = 0, rate = planned.rate; step < kMostSteps && (coarser = relaxed(*coarser, step)); ++step)
        if (coarser->rate != std::exchange(rate, coarser->rate)) {
            draw(own, *coarser, false);
            draw(own, finer(*coarser), true); // of eyes near the medium, to which that is fine enough
        }
}

std::unique_ptr<Process> startAhead(const Scene& scene, std::vector<std::string> command) {
    if (Simulation(standIn(scene)).capacity() > kMostParticles) return nullptr;
    command[0] = "/proc/self/exe";
    command.insert(command.end(), {"--ahead", "only", "--log-file", "", "--log-level", "error"});
    try {
        return std::make_unique<Process>(command);
    } catch (const std::system_error& error) {
        spdlog::debug("shaders are not compiled ahead: {}", error.what());
        return nullptr;
    }
}

void stepBehind() { [[maybe_unused]] const int niceness = ::nice(19); }

} // namespace brume
