#include "server/compile/ahead.h"

#include <ctime>
#include <optional>
#include <ostream>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include "server/compile/warm_up.h"
#include "server/gpu/pipeline_cache.h"
#include "server/medium/band_limit.h"
#include "server/methods/plans.h"
#include "server/sim/sequence_files.h"

namespace brume {
namespace {

constexpr uint32_t kMostParticles = 100'000;                   // those of a second process take as much memory again
constexpr uint32_t kHeights[] = {360, 180, 720, 90, 270, 540}; // pixels; widths in 16:9
constexpr uint32_t kMostSteps = 12;                            // steps of overload that are compiled, at most
// Niceness. With 19 it would hardly get on beside other programs, and pictures wait for what it makes.
constexpr int kNiceness = 10;
// s of CPU time with the server's own priority. A driver that knows the shaders is done with most of them, and the
// server may measure errors; one that compiles them would take a core from the pictures for half a minute.
constexpr double kSoon = 1.5;

// Compiles ways one by one, each once.
class Compiling {
public:
    Compiling(const Scene& scene, const gpu::Device& device, const Simulation& simulation, std::ostream& out)
        : listener_(device.pipelines(), [this](const std::string& text) { made_.push_back(text); }),
          renderer_(device, scene, simulation.capacity()), submission_(device, "ahead"),
          pictures_(renderer_, submission_, scene, simulation, true), out_(out) {}
    ~Compiling() { tell(); }

    void compile(const RenderSettings& settings, bool still) {
        const WayShaders way = shadersOf(settings, still);
        if (!done_.insert(way).second) return;
        if (std::clock() > kSoon * CLOCKS_PER_SEC) stepBehind();
        pictures_.drawForEveryCamera(settings, still);
        tell(); // the driver has had time to write what it compiled before
        drawn_ = way;
        pipelines_ = std::exchange(made_, {});
    }
    // Views of how pictures are made, whatever the way.
    void compileViews(const RenderSettings& settings) {
        for (const bool still : {false, true}) pictures_.drawViews(settings, still);
        tell();
        pipelines_ = std::exchange(made_, {});
    }
    const PlanView& inside() const { return pictures_.inside(); }

private:
    // Lowers the priority for good.
    static void stepBehind() { [[maybe_unused]] const int niceness = ::setpriority(PRIO_PROCESS, 0, kNiceness); }
    void tell() {
        for (const std::string& pipeline : std::exchange(pipelines_, {})) out_ << kPipeline << pipeline << '\n';
        if (const auto way = std::exchange(drawn_, std::nullopt)) out_ << kCompiled << text(*way) << '\n';
        out_ << std::flush;
    }

    std::vector<std::string> made_; // pipelines, of what is drawn
    gpu::PipelineListener listener_;
    Renderer renderer_;
    Submission submission_;
    WarmUp pictures_;
    std::ostream& out_;
    std::set<WayShaders> done_;
    std::optional<WayShaders> drawn_;    // not told yet
    std::vector<std::string> pipelines_; // not told yet
};

// The way for one viewer once the medium was seen to rest, if it does.
RenderSettings settled(const Scene& scene, const CostModel& costs, double frame_budget_ms) {
    Simulation simulation(standIn(scene));
    Planner planner(scene, costs, frame_budget_ms);
    const PlanView own = ownView(scene);
    planner.settings(simulation, {&own, 1}, true, Planner::Time::clock::now());
    simulation.step({});
    return planner.settings(simulation, {&own, 1}, true, Planner::Time::clock::now());
}

// The ways that overload takes, step by step.
std::vector<RenderSettings> coarserThan(const RenderSettings& planned, uint32_t most) {
    std::vector<RenderSettings> ways;
    for (std::optional<RenderSettings> way = planned; ways.size() < most;) {
        way = relaxed(*way, uint32_t(ways.size()));
        if (!way) break;
        ways.push_back(*way);
    }
    return ways;
}

} // namespace

void compileAhead(const Scene& scene, const gpu::Device& device, const CostModel& costs, double frame_budget_ms,
                  std::ostream& out) {
    const Simulation simulation(standIn(scene));
    Compiling compiling(scene, device, simulation, out);
    Planner planner(scene, costs, frame_budget_ms);
    const PlanView own = ownView(scene);
    const RenderSettings planned = planner.settings(simulation, {&own, 1}, true, Planner::Time::clock::now());
    const auto compile = [&](const RenderSettings& settings) { // for eyes that move and that rest
        compiling.compile(settings, false);
        compiling.compile(settings, true);
        compiling.compile(finer(settings), true);
    };
    const RenderSettings resting = settled(scene, costs, frame_budget_ms);
    compiling.compile(resting, false); // first: the server has compiled `planned` itself
    // What overload gives up, as eyes that move see it: before all else where it will.
    if (planner.plan().chosen.ms() > frame_budget_ms)
        for (const RenderSettings& way : coarserThan(planned, kMostSteps / 2)) compiling.compile(way, false);
    compile(planned);
    compile(resting);
    compiling.compile(finer(planned), false); // while cameras rest and the medium moves
    if (scene.render.rate != kAuto) return compiling.compileViews(planned);
    // Viewers near and far, with large and small pictures, together and alone.
    compile(planner.once(simulation, compiling.inside()).settings);
    for (const uint32_t height : kHeights) {
        const PlanView view{own.pose, height * 16 / 9, height};
        RenderSettings together = planned;
        if (const uint32_t rate = planner.rateOf(view, planned, false)) together.rate = rate;
        compile(together);
        compile(planner.once(simulation, view).settings);
    }
    for (const RenderSettings& way : coarserThan(planned, kMostSteps)) compile(way);
    RenderSettings other = planned;
    if (planOf(planned.method)->hasRays())
        for (const uint32_t rate : kRates) other.rate = rate, compile(other);
    compiling.compileViews(planned); // last: few ask for them
}

void makePipelines(const Scene& scene, const gpu::Device& device, const WayShaders& way) {
    const Simulation simulation(standIn(scene));
    Renderer renderer(device, scene, simulation.capacity());
    Submission submission(device, "behind");
    WarmUp pictures(renderer, submission, scene, simulation, true);
    way.layers ? pictures.drawLayers(scene.render) : pictures.drawForEveryCamera(scene.render, way.still);
}

bool isWorthCompiling(const Scene& scene) { return Simulation(standIn(scene)).capacity() <= kMostParticles; }

std::unique_ptr<Process> startAhead(std::vector<std::string> command, std::span<const std::string> overrides,
                                    std::function<void()> on_line) {
    command[0] = "/proc/self/exe";
    command.insert(command.end(), {"--ahead", "only", "--log-file", "", "--log-level", "error"});
    for (const std::string& setting : overrides) command.insert(command.end(), {"--set", setting});
    try {
        return std::make_unique<Process>(command, std::vector<std::string>(), std::move(on_line));
    } catch (const std::system_error& error) {
        spdlog::debug("shaders are not compiled ahead: {}", error.what());
        return nullptr;
    }
}

} // namespace brume
