#include "server/ahead.h"

#include <ctime>
#include <optional>
#include <ostream>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include "server/medium/band_limit.h"
#include "server/methods/plans.h"
#include "server/sim/sequence_files.h"
#include "server/warm_up.h"

namespace brume {
namespace {

constexpr uint32_t kMostParticles = 100'000;                   // those of a second process take as much memory again
constexpr uint32_t kHeights[] = {360, 180, 720, 90, 270, 540}; // pixels; widths in 16:9
constexpr uint32_t kMostSteps = 12;                            // of overload
// s of CPU time with the server's own priority. A driver that knows the shaders is done with most of them, and the
// server may measure errors; one that compiles them would take a core from the pictures for half a minute.
constexpr double kSoon = 1.5;

// Compiles ways one by one, each once.
class Compiling {
public:
    Compiling(const Scene& scene, const gpu::Device& device, const Simulation& simulation, std::ostream& out)
        : renderer_(device, scene, simulation.capacity()), submission_(device, "ahead"),
          pictures_(renderer_, submission_, scene, simulation, true), out_(out) {}
    ~Compiling() { tell(); }

    void compile(const RenderSettings& settings, bool still) {
        const WayShaders way = shadersOf(settings, still);
        if (!done_.insert(way).second) return;
        if (std::clock() > kSoon * CLOCKS_PER_SEC) stepBehind();
        pictures_.drawForEveryCamera(settings, still);
        tell(); // the driver has had time to write what it compiled before
        drawn_ = way;
    }
    // Views of how pictures are made, whatever the way.
    void compileViews(const RenderSettings& settings) {
        for (const bool still : {false, true}) pictures_.drawViews(settings, still);
    }
    const PlanView& inside() const { return pictures_.inside(); }

private:
    // Lowers the priority for good.
    static void stepBehind() { [[maybe_unused]] const int niceness = ::setpriority(PRIO_PROCESS, 0, 19); }
    void tell() {
        if (const auto way = std::exchange(drawn_, std::nullopt)) out_ << kCompiled << text(*way) << std::endl;
    }

    Renderer renderer_;
    Submission submission_;
    WarmUp pictures_;
    std::ostream& out_;
    std::set<WayShaders> done_;
    std::optional<WayShaders> drawn_; // not told yet
};

struct AsToml {
    std::string operator()(glm::vec3 v) const { return fmt::format("[{},{},{}]", v.x, v.y, v.z); }
    template <class Value>
    std::string operator()(const Value& value) const {
        return fmt::format("{}", value);
    }
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
    std::optional<RenderSettings> coarser = planned;
    for (uint32_t step = 0; step < kMostSteps && (coarser = relaxed(*coarser, step)); ++step) compile(*coarser);
    RenderSettings other = planned;
    if (planOf(planned.method)->hasRays())
        for (const uint32_t rate : kRates) other.rate = rate, compile(other);
    compiling.compileViews(planned); // last: few ask for them
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

std::vector<std::string> presentOverrides(const SceneFacts& facts, std::span<const SettingValue> settings,
                                          const SceneFeatures& lists) {
    std::vector<std::string> all;
    Light sun = sunOf(facts.scene);
    for (size_t i = 0; i < settings.size(); ++i) {
        const SceneSetting& setting = *liveSettings()[i];
        if (setting.table() == "light")
            apply({setting.path, settings[i]}, {.light = &sun});
        else if (settings[i] != facts.starts[i])
            all.push_back(fmt::format("{}={}", setting.path, std::visit(AsToml(), settings[i])));
    }
    const SceneLists own = listsOf(facts.scene);
    if (!lists.bodies) all.insert(all.end(), {"box=[]", "sphere=[]"});
    if (lists.bodies && !featuresOf(own).bodies) all.emplace_back("box=[{}]");
    if (!lists.opaque) all.emplace_back("plane=[]");
    if (lists.opaque && !lists.bodies && !lists.local_lights && own.planes.empty()) all.emplace_back("plane=[{}]");
    all.push_back(fmt::format("fog=[{}]", lists.glow ? "{emission=[1,1,1]}" : lists.fog ? "{}" : ""));
    all.push_back(fmt::format("light=[{{to_light={},irradiance={}}}{}]", AsToml()(sun.to_light),
                              AsToml()(sun.irradiance), lists.local_lights ? ",{type='point'}" : ""));
    return all;
}

std::vector<std::string> wayOverrides(const RenderSettings& way) {
    std::vector<std::string> all{"render.method=" + way.method,
                                 "render.isv.quadrature=" + way.isv.quadrature,
                                 fmt::format("render.isv.steps={}", way.isv.steps),
                                 fmt::format("render.isv.fading={}", way.isv.fading),
                                 fmt::format("render.isv.soft_shadows={}", way.isv.soft_shadows),
                                 fmt::format("render.isv.multiple={}", way.isv.multiple),
                                 "render.tiles.quadrature=" + way.tiles.quadrature};
    if (way.rate != kAuto) all.push_back(fmt::format("render.rate={}", way.rate));
    if (way.slabs != kAuto) all.push_back(fmt::format("render.slabs={}", way.slabs));
    if (way.grid.spacing != kAuto) all.push_back(fmt::format("render.grid.spacing={}", way.grid.spacing));
    return all;
}

} // namespace brume
