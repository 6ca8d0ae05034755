#include "server/compilers.h"

#include <csignal>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include "common/text.h"
#include "server/compile/ahead.h"
#include "server/loop/present_overrides.h"
#include "server/sim/sequence_files.h"

namespace brume {
namespace {

constexpr int kBehind = 5; // niceness of the thread that makes pipelines: it gives way to pictures, and gets on

} // namespace

void wakeMain() { ::kill(::getpid(), SIGUSR1); }

Compilers::Compilers(const ServerOptions& options, const Server& server) : options_(options), server_(server) {
    server_.frames.compiledWays().serve(wakeMain);
}

Compilers::~Compilers() { server_.frames.compiledWays().serve(nullptr); }

// Only the options' own scene is known to a second process by its arguments; others are given in addition.
void Compilers::begin(const Scene& scene, const std::filesystem::path& file, Load load) {
    ahead_ = {}, behind_ = {};
    command_.clear();
    on_disk_.clear();
    load_ = std::move(load);
    if (options_.ahead == "background" && isWorthCompiling(scene)) {
        command_.assign(server_.argv, server_.argv + server_.argc);
        command_.insert(command_.end(), {"--scene", file.string()});
        ahead_ = {startAhead(command_, {}, wakeMain), server_.frames.compiledWays().features(), {}};
        if (!ahead_.process) command_.clear();
    }
    server_.frames.compiledWays().setAll(command_.empty());
}

// Lists that pictures do not show yet come first: everybody waits to see them. Ways for those before wait meanwhile.
void Compilers::look() {
    CompiledWays& ways = server_.frames.compiledWays();
    const bool goes_on = hear(ahead_);
    if (const auto lists = ways.wantedFeatures(); lists && !command_.empty() && !(goes_on && ahead_.lists == *lists)) {
        if (const auto job = jobOf(*lists, nullptr, overridesOf(*lists, nullptr)); job && isOnDisk(*job)) {
            makeReady(*job);
        } else {
            ahead_ = start(*lists, nullptr);
            if (!ahead_.process) ways.add(*lists, {}); // compiled where it is drawn
        }
    }
    if (!command_.empty() && ways.wantedFeatures()) return void(behind_ = {});
    const bool goes_on_behind = hear(behind_);
    // What one process has compiled does not wait for what another compiles. Layers take a second, and no process.
    const auto is_on_disk = [&](const CompiledWays::Wanted& wanted) {
        if (wanted.shaders.layers) return true;
        const auto known = on_disk_.find(wanted.lists); // other lists may be drawn meanwhile
        return known != on_disk_.end() && known->second.contains(wanted.shaders);
    };
    while (const auto wanted = command_.empty() ? std::nullopt : ways.nextWanted(is_on_disk)) {
        if (const auto job = jobOf(wanted->lists, &*wanted, overridesOf(wanted->lists, &*wanted))) makeReady(*job);
        ways.add(wanted->lists, wanted->shaders); // if nothing could be done: compiled where it is drawn
    }
    if (goes_on_behind) return;
    while (const auto wanted = command_.empty() ? std::nullopt : ways.nextWanted()) {
        behind_ = start(wanted->lists, &*wanted);
        if (behind_.process) return;
        ways.add(wanted->lists, wanted->shaders);
    }
}

// For the scene as it is now. `wanted`: little else than this way is compiled; null: all that may be needed.
Compilers::Compiler Compilers::start(const SceneFeatures& lists, const CompiledWays::Wanted* wanted) const {
    const std::vector<std::string> overrides = overridesOf(lists, wanted);
    return {startAhead(command_, overrides, wakeMain), lists, jobOf(lists, wanted, overrides)};
}

std::vector<std::string> Compilers::overridesOf(const SceneFeatures& lists, const CompiledWays::Wanted* wanted) const {
    return presentOverrides(*server_.audience.scene(), server_.audience.report()->settings, lists,
                            wanted ? &wanted->settings : nullptr);
}

// Nothing: the scene's files are not what they were. The first way for other lists is what compileAhead() plans for
// them.
std::optional<Compilers::Job> Compilers::jobOf(const SceneFeatures& lists, const CompiledWays::Wanted* wanted,
                                               std::span<const std::string> overrides) const {
    try {
        Job job{.lists = lists, .scene = load_(overrides)};
        if (wanted) {
            job.scene.render = wanted->settings;
            job.way = wanted->shaders;
            return job;
        }
        const Simulation simulation(standIn(job.scene));
        const PlanView own = ownView(job.scene);
        job.scene.render = Planner(job.scene, server_.costs, options_.frame.frame_ms)
                               .settings(simulation, {&own, 1}, true, Planner::Time::clock::now());
        job.way = shadersOf(job.scene.render, false);
        return job;
    } catch (const std::exception& error) {
        spdlog::debug("the scene cannot be loaded again: {}", error.what());
        return {};
    }
}

bool Compilers::isOnDisk(const Job& job) const {
    const auto known = on_disk_.find(job.lists);
    return known != on_disk_.end() && known->second.contains(job.way);
}

void Compilers::makeReady(const Job& job) {
    makeBeside(job.scene, job.way);
    spdlog::debug("compiled: {}", text(job.way));
    server_.frames.compiledWays().add(job.lists, job.way);
}

void Compilers::prepare(const Scene& scene) const {
    if (options_.ahead != "background" || !isWorthCompiling(scene)) return;
    const Simulation simulation(standIn(scene));
    const PlanView own = ownView(scene);
    Scene shown = scene;
    shown.render = Planner(scene, server_.costs, options_.frame.frame_ms)
                       .settings(simulation, {&own, 1}, true, Planner::Time::clock::now());
    makeBeside(shown, shadersOf(shown.render, false));
}

// Pictures wait for nothing. The thread's priority is lowered for good. What fails here fails where it is drawn, and is
// told of there.
void Compilers::makeBeside(const Scene& scene, const WayShaders& way) const {
    std::thread([&] {
        [[maybe_unused]] const int niceness = ::setpriority(PRIO_PROCESS, 0, kBehind); // this thread's, on Linux
        try {
            makePipelines(scene, server_.device, way);
        } catch (const std::exception& error) {
            spdlog::debug("pipelines of {} are made when they are drawn with: {}", text(way), error.what());
        }
    }).join();
}

// Notes what it has compiled. True: it goes on. What it was started for counts as compiled at its end, however that
// came: nobody waits for ever.
bool Compilers::hear(Compiler& compiler) {
    if (!compiler.process) return false;
    const bool ended = compiler.process->exitCode(std::chrono::milliseconds(0)).has_value();
    const std::string out = compiler.process->out();
    for (size_t end; (end = out.find('\n', compiler.heard)) != out.npos; compiler.heard = end + 1) {
        const std::string line = out.substr(compiler.heard, end - compiler.heard);
        if (line.starts_with(kPipeline)) server_.frames.compiledWays().addPipeline(line.substr(kPipeline.size()));
        if (const auto way = line.starts_with(kCompiled) ? wayShaders(line.substr(kCompiled.size())) : std::nullopt)
            on_disk_[compiler.lists].insert(*way);
    }
    if (ended && compiler.process->exitCode() != 0)
        spdlog::warn("compiling shaders ahead ended with {}, so pictures may wait for them: {}",
                     *compiler.process->exitCode(), oneLine(compiler.process->err()));
    if (compiler.job && (ended || isOnDisk(*compiler.job))) {
        on_disk_[compiler.lists].insert(compiler.job->way);
        makeReady(*std::exchange(compiler.job, std::nullopt));
    }
    if (!ended) return true;
    if (server_.frames.compiledWays().wantedFeatures() == compiler.lists)
        server_.frames.compiledWays().add(compiler.lists, {});
    compiler = {};
    return false;
}

} // namespace brume
