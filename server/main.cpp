// brume-server: owns everything, starts it in order, waits for a signal or a failure, and stops it in the opposite order.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "server/net/server.h"
#include "server/options.h"

namespace {

using namespace brume;

void startLog(const ServerOptions& options) {
    spdlog::sink_ptr sink;
    if (options.log_file.empty())
        sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
    else
        sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(options.log_file.string());
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("brume", sink));
    spdlog::set_level(spdlog::level::from_str(options.log_level));
    spdlog::flush_on(spdlog::level::info);
}

std::string address(const net::NetOptions& options, uint16_t port) {
    const std::string host = options.listen.find(':') == std::string::npos ? options.listen : "[" + options.listen + "]";
    return "http://" + host + ":" + std::to_string(port);
}

CostModel costsOf(const ServerOptions& options, const gpu::Device& device) {
    std::string complaint;
    CostModel costs = loadCosts(costFile(options.costs, device.name(), device.driver()), complaint);
    if (!complaint.empty()) spdlog::warn("{}", complaint);
    return costs;
}

std::string explained(const Scene& scene, const CostModel& costs) {
    PlanInputs inputs;
    inputs.scene = planScene(scene, Simulation(scene));
    inputs.views = {ownView(scene)};
    inputs.methods = methodNames();
    return explain(makePlan(inputs, costs), inputs, costs);
}

void serve(const ServerOptions& options, const sigset_t& signals) {
    const Scene scene = loadScene(options);
    const gpu::Device device(options.device);
    const CostModel costs = costsOf(options, device);
    if (options.explain) {
        std::cout << explained(scene, costs);
        return;
    }
    SceneFacts facts{scene.name, device.name(), scene.camera, {kAutoMethod}, {}};
    for (const MethodInfo& method : methods()) facts.methods.emplace_back(method.name);
    for (const char* quadrature : quadratures()) facts.quadratures.emplace_back(quadrature);
    Audience audience(facts, options.max_viewers, options.max_in_flight);
    audience.admitUpTo(options.most_frame_ms);
    Metrics metrics;
    FrameLoop::Options frame = options.frame;
    frame.costs = costs;
    FrameLoop frames(scene, device, audience, metrics, frame);
    NetServer network(options.net, audience, metrics);

    network.start(); // a taken port ends it here, before the first frame
    frames.start([] { ::kill(::getpid(), SIGTERM); });
    if (!std::filesystem::exists(options.net.web_root / "index.html"))
        spdlog::warn("no page in '{}': run ./dev build, or name its folder with --web-root", options.net.web_root.string());
    spdlog::info("scene '{}' on {}{}", scene.name, device.name(), device.hasMeshShaders() ? ", mesh shaders" : "");
    std::cout << "listening on " << address(options.net, network.port()) << std::endl;

    int signal = 0;
    sigwait(&signals, &signal);
    spdlog::info("stopping");
    audience.ready = false;
    network.stop(options.grace);
    frames.stop();
    if (device.validationMessages() > 0)
        throw gpu::Error("the validation layer had " + std::to_string(device.validationMessages()) + " messages");
    if (frames.failure()) std::rethrow_exception(frames.failure());
}

} // namespace

int main(int argc, char** argv) {
    const ParsedOptions parsed = parseServerOptions(argc, argv);
    if (!parsed.options) return parsed.exit_code;

    // Signals are taken by sigwait alone: blocked here, before any thread starts and inherits it.
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::signal(SIGPIPE, SIG_IGN);

    try {
        startLog(*parsed.options);
        serve(*parsed.options, signals);
        return 0;
    } catch (const std::exception& e) {
        std::cerr << "brume-server: " << e.what() << std::endl;
        return 1;
    }
}
