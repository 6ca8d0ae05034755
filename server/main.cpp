// brume-server: owns everything, starts it in order, waits for a signal or a failure, and stops it in the opposite
// order.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <stdexcept>

#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include "protocol/net/address.h"
#include "server/compile/ahead.h"
#include "server/ending.h"
#include "server/last_line.h"
#include "server/net/server.h"
#include "server/operate/log.h"
#include "server/operate/replay.h"
#include "server/operate/replay_ticks.h"
#include "server/options/options.h"
#include "server/reload.h"
#include "server/room.h"
#include "server/room_keeper.h"
#include "server/sim/point_cloud.h"

namespace {

using namespace brume;

constexpr std::chrono::milliseconds kEndsWithin{1500}; // once all connections are closed

std::string address(const net::NetOptions& options, uint16_t port) {
    const std::string host =
        options.listen.find(':') == std::string::npos ? options.listen : "[" + options.listen + "]";
    return (options.tls_key.empty() ? "http://" : "https://") + host + ":" + std::to_string(port);
}

CostModel costsOf(const ServerOptions& options, const gpu::Device& device) {
    std::string complaint;
    CostModel costs = loadCosts(costFile(options.costs, device.name(), device.driver()), complaint);
    if (!complaint.empty()) spdlog::warn("{}", complaint);
    costs.on_cpu = device.isCpu();
    if (!costs.learnt) return costs;
    if (const std::string unusual = unusualCosts(costs); !unusual.empty())
        spdlog::info("costs learnt before differ much from the built-in ones: {}; half of it is forgotten", unusual);
    return halfForgotten(costs);
}

std::string explained(const Scene& scene, const CostModel& costs) {
    PlanInputs inputs;
    const Simulation simulation(scene);
    tellOfPointCloud(scene, simulation);
    inputs.scene = planScene(scene, simulation);
    inputs.views = {ownView(scene)};
    inputs.methods = allMethods();
    return explain(makePlan(inputs, costs), inputs, costs);
}

// /readyz fails, all else goes on until the time is over or the frame loop fails. Another signal to end is obeyed at
// once.
void drain(NetServer& network, Audience& audience, std::chrono::milliseconds time, const sigset_t& signals,
           const std::function<bool()>& failed) {
    network.drain();
    audience.ready = false;
    if (time.count() == 0 || failed()) return;
    spdlog::info("draining for {} ms: /readyz fails, frames go on", time.count());
    const auto deadline = Clock::now() + time;
    for (auto left = time; left.count() > 0;
         left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now())) {
        const timespec wait{left.count() / 1000, left.count() % 1000 * 1'000'000};
        const int signal = ::sigtimedwait(&signals, nullptr, &wait);
        if (signal == SIGHUP) spdlog::warn("no reload: the server drains");
        if (failed()) return;
        if (signal == SIGTERM || signal == SIGINT) std::_Exit(128 + signal);
    }
}

void serve(ParsedOptions& parsed, int argc, char** argv, const sigset_t& signals, Ending& ending) {
    const ServerOptions& options = *parsed.options;
    if (!options.explain && options.ahead != "only") ending.serves();
    const bool replayed = !options.replay.empty();
    const std::optional<RecordingExtent> recording =
        replayed ? std::optional<RecordingExtent>(options.replay) : std::nullopt;
    Scene scene = replayed ? sceneOf(recording->head) : loadScene(options);
    nameLog(*parsed.options, scene);
    const gpu::Device device(options.device);
    const CostModel costs = costsOf(options, device);
    if (options.explain) {
        std::cout << explained(scene, costs);
        return;
    }
    if (options.ahead == "only") return compileAhead(scene, device, costs, options.frame.frame_ms, std::cout);
    checkNetwork(options.net); // before shaders are compiled, which may take a minute
    const auto failed = [] { ::kill(::getpid(), SIGTERM); };
    DeviceTurns turns;
    const SharedByRooms shared{device, costs, turns, argc, argv};
    ServedRoom home("", options, shared, std::move(scene), recording ? &*recording : nullptr);
    RoomKeeper rooms(options, shared, failed);
    NetServer network(options.net, home.audience(), home.metrics());
    if (cluster::Node* const node = home.node()) network.setElsewhere([node] { return node->elsewhere(); });

    network.start();
    ending.started(); // a loop that fails says so by SIGTERM
    home.start(failed);
    if (!replayed) rooms.serve(network.rooms());
    if (!std::filesystem::exists(options.net.web_root / "index.html"))
        spdlog::warn("no page in '{}': run ./dev build, or name its folder with --web-root",
                     options.net.web_root.string());
    spdlog::info("scene '{}' on {}{}", home.scene().name, device.name(),
                 device.hasMeshShaders() ? ", mesh shaders" : "");
    if (options.net.token_key.empty() && options.open &&
        (!isLoopback(options.net.listen) || options.net.proxy_protocol || !options.net.trusted_proxies.empty()))
        spdlog::warn("open: everyone who can reach {} may look, push and change the scene; --token-key FILE ends that",
                     options.net.proxy_protocol             ? "the gateway"
                     : !options.net.trusted_proxies.empty() ? "the proxy"
                                                            : options.net.listen);
    if (replayed)
        spdlog::info("replay of '{}', ticks {} to {}", options.replay.string(), recording->head.tick, recording->last);
    std::cout << "listening on " << address(options.net, network.port()) << std::endl;

    int signal = 0;
    SceneThread* const scenes = home.scenes();
    const auto eachScenes = [&](const auto& use) {
        if (scenes) use(*scenes);
        rooms.each([&](ServedRoom& room) { use(*room.scenes()); });
    };
    while (sigwait(&signals, &signal) == 0 && (signal == SIGHUP || signal == SIGCHLD || signal == SIGUSR1)) {
        if (signal == SIGHUP && !scenes) spdlog::warn("no reload: this is a replay");
        if (signal == SIGHUP && scenes) reload(parsed, argc, argv, {home, rooms, network});
        if (signal == SIGUSR1) eachScenes([](SceneThread& one) { one.serveRequests(); });
        if (signal == SIGCHLD) eachScenes([](SceneThread& one) { one.compileBehind(); });
    }
    const auto anyFailed = [&] {
        bool any = home.failed();
        rooms.each([&](ServedRoom& room) { any = any || room.failed(); });
        return any;
    };
    const auto eachRoom = [&](const auto& use) {
        use(home);
        rooms.each(use);
    };
    eachRoom([](ServedRoom& room) {
        if (room.node()) room.node()->drain();
    });
    drain(network, home.audience(), options.drain, signals, anyFailed);
    spdlog::info("stopping");
    eachRoom([](ServedRoom& room) { room.willStop(); });
    std::signal(SIGUSR1, SIG_IGN); // no scene is shown any more
    std::signal(SIGTERM, SIG_DFL); // a second one ends the process at once
    std::signal(SIGINT, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    network.stop(options.grace, options.drain_to);
    ending.within(kEndsWithin);
    rooms.end(); // waits for a room that is being opened
    eachRoom([](ServedRoom& room) { room.stop(); });
    try {
        if (device.validationMessages() > 0)
            throw gpu::Error("the validation layer had " + std::to_string(device.validationMessages()) + " messages");
        eachRoom([](ServedRoom& room) {
            if (room.frames().failure()) std::rethrow_exception(room.frames().failure());
        });
    } catch (const std::exception& error) {
        ending.failed(lastLine(error));
        throw;
    }
}

// Memory that pictures needed for a moment goes back to the system. By default glibc keeps more for each thread, the
// larger the blocks are that were freed.
void keepLittleMemory() {
    mallopt(M_MMAP_THRESHOLD, 1 << 20); // bytes: a larger block goes back when it is freed
    mallopt(M_TRIM_THRESHOLD, 2 << 20); // bytes that are free at the end of a thread's heap, at most
}

// A driver for CPUs keeps memory of the device in a file without a name. One that may not grow ends the process by a
// signal when it is written to.
void checkFileLimit() {
    constexpr rlim_t kLeast = 64 << 20; // bytes
    rlimit files{};
    if (::getrlimit(RLIMIT_FSIZE, &files) == 0 && files.rlim_cur < kLeast)
        throw std::runtime_error(fmt::format(
            "files may have {} bytes at most here; allowed: 64 MiB or more (ulimit -f)", uint64_t{files.rlim_cur}));
}

} // namespace

int main(int argc, char** argv) {
    keepLittleMemory();
    ParsedOptions parsed = parseServerOptions(argc, argv);
    if (!parsed.options) {
        if (!parsed.complaint.empty())
            std::cerr << "brume-server: " << parsed.complaint << " (see brume-server --help)\n";
        return parsed.exit_code;
    }

    // Signals are taken by sigwait alone: blocked here, before any thread starts and inherits it.
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGCHLD);
    sigaddset(&signals, SIGHUP);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGUSR1);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN); // a file that grows too large is a write that fails

    endInOneLine();
    try {
        const ServerOptions& options = *parsed.options;
        startLog(options.log_level, options.log_format, options.log_file);
        checkFileLimit();
        Ending ending(signals);
        if (options.replay.empty() || options.look)
            serve(parsed, argc, argv, signals, ending);
        else
            replay({options.replay,
                    options.frames,
                    options.device,
                    {options.out, options.fps, options.format == "png", (options.height * 16 / 9 + 1) / 2 * 2,
                     options.height}},
                   std::cout);
        return 0;
    } catch (const std::exception& e) {
        std::cerr << "brume-server: " << lastLine(e) << std::endl;
        return 1;
    }
}
