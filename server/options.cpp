#include "server/options.h"

#include <cstdio>
#include <iostream>

#include <CLI/CLI.hpp>

#include "common/scene_limits.h"
#include "server/plan/plan.h"

namespace brume {
namespace {

// The first of the places where a folder of ours may be: installed beside the program, in the source tree, here.
std::filesystem::path findFolder(const char* installed, const char* in_source) {
    std::error_code error;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    for (const auto& folder :
         {program / "../share/brume" / installed, program / "../../.." / in_source, std::filesystem::path(in_source)})
        if (std::filesystem::is_directory(folder, error)) return std::filesystem::canonical(folder, error);
    return in_source;
}

CLI::Range within(const Limits& limits) { return {limits.lo, limits.hi}; }

} // namespace

ParsedOptions parseServerOptions(int argc, const char* const* argv) {
    ServerOptions o;
    o.scene_dir = findFolder("scenes", "server/scenes");
    o.net.web_root = findFolder("web", "client/web/dist");
    o.costs = defaultCostFolder();
    CLI::App app{"brume-server: simulates one cloud, lights it once and renders it for every viewer."};
    app.set_version_flag("--version", "brume-server " BRUME_VERSION);
    app.option_defaults()->always_capture_default()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    const auto ms = [&](const char* name, std::chrono::milliseconds& value, const char* about) {
        app.add_option_function<uint32_t>(
               name, [&value](uint32_t v) { value = std::chrono::milliseconds(v); }, about)
            ->default_str(std::to_string(value.count()))
            ->check(CLI::Range(1u, 3'600'000u))
            ->type_name("MS");
    };

    const char* group = "Scene";
    app.add_option("--scene", o.scene, "name of a scene, or the path of a .toml file")->group(group);
    app.add_option("--scene-dir", o.scene_dir, "folder of the scenes known by name")->group(group);
    app.add_option("--set", o.overrides, "a setting instead of the scene's, as in its file: --set medium.count=5000")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->type_name("KEY=VALUE")
        ->default_str("")
        ->group(group);
    app.add_option("--method", o.method, "medium method instead of the scene's; auto: the cheapest within render.error")
        ->group(group);
    app.add_option("--quadrature", o.quadrature, "simpson | transmittance | analytic, for method isv")->group(group);
    app.add_option("--steps", o.steps, "of the quadrature")->group(group)->check(within(limits::kSteps));
    app.add_option("--exposure", o.exposure, "factor before the tone map")->group(group)->check(within(limits::kExposure));
    app.add_option("--cutoff", o.cutoff, "bound on the optical depth that proxies leave out of any ray")
        ->group(group)
        ->check(within(limits::kCutoff));
    app.add_option("--shadow-size", o.shadow_size, "texels a side of the volumetric shadow map; 0: as the medium needs")
        ->group(group)
        ->check(within(limits::kShadowSize) | CLI::IsMember({0}));
    app.add_option("--shadow-slices", o.shadow_slices, "its planes; 0: as the medium needs")
        ->group(group)
        ->check(within(limits::kShadowSlices) | CLI::IsMember({0}));
    app.add_option("--shadow-error", o.shadow_error, "relative error of the light that a map of such a size may make")
        ->group(group)
        ->check(within(limits::kShadowError));
    app.add_flag("--paused", o.paused, "start with the simulation paused")->group(group);

    group = "Network";
    app.add_option("--listen", o.net.listen, "address; 0.0.0.0 or :: lets other machines in")->group(group);
    app.add_option("--port", o.net.port, "0 takes a free one")->group(group);
    app.add_option("--web-root", o.net.web_root, "folder of the built page")->group(group);
    app.add_option("--allow-origin", o.net.allowed_origins, "pages of this origin may connect too; * for any")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->group(group);

    group = "Limits";
    app.add_option("--max-viewers", o.max_viewers, "MJPEG streams and snapshots count")->group(group)->check(CLI::Range(1, 1000));
    app.add_option("--max-in-flight", o.max_in_flight, "frames a viewer may leave unacknowledged")
        ->group(group)
        ->check(CLI::Range(1, 16));
    app.add_option_function<uint32_t>(
           "--memory", [&o](uint32_t mib) { o.frame.memory = uint64_t{mib} << 20; },
           "that particles may take on the CPU and on the device; a scene with more is refused")
        ->default_str(std::to_string(o.frame.memory >> 20))
        ->check(CLI::Range(1u, 65536u))
        ->type_name("MIB")
        ->group(group);
    app.add_option("--max-connections", o.net.max_connections, "open sockets")->group(group)->check(CLI::Range(1, 65535));
    app.add_option("--max-connections-per-address", o.net.max_connections_per_address, "open sockets of one address")
        ->group(group)
        ->check(CLI::Range(1, 65535));
    app.add_option("--max-streams", o.net.max_streams, "MJPEG streams at a time")->group(group)->check(CLI::Range(0, 1000));
    app.add_option("--max-pixels", o.net.max_pixels, "of one picture; a larger wish is scaled down")
        ->group(group)
        ->check(CLI::Range(256, 8192 * 8192));
    app.add_option("--max-message-bytes", o.net.max_message_bytes, "of one message from a viewer")
        ->group(group)
        ->check(CLI::Range(1024, 1 << 20));
    app.add_option("--quality", o.net.default_quality, "JPEG quality unless a viewer wishes another")
        ->default_str(std::to_string(o.net.default_quality))
        ->group(group)
        ->check(CLI::Range(1, 100));
    ms("--handshake", o.net.handshake, "a connection must say what it wants within this");
    ms("--idle", o.net.idle, "a viewer that is silent for this long is closed");
    ms("--grace", o.grace, "to end what is open when told to stop");

    group = "Device";
    app.add_option("--device", o.device.name, "part of the Vulkan device's name; default: a GPU before a CPU driver")
        ->group(group);
    app.add_flag("--validation", o.device.validation, "run under the Vulkan validation layer")->group(group);
    bool no_mesh = false;
    app.add_flag("--no-mesh-shaders", no_mesh, "use the vertex path even where mesh shaders exist")->group(group);
    app.add_option("--costs", o.costs, "folder of what brume-bench calibrate measured; without its file built-in costs hold")
        ->group(group);
    app.add_option("--frame-budget", o.frame.frame_ms, "that a frame of all viewers may take before accuracy is given up")
        ->group(group)
        ->check(CLI::Range(1.0, 10'000.0))
        ->type_name("MS");
    app.add_option("--most-frame-time", o.most_frame_ms,
                   "that a frame of all viewers may take: newcomers are told to come back later")
        ->group(group)
        ->check(CLI::Range(1.0, 60'000.0))
        ->type_name("MS");
    app.add_flag("--explain", o.explain, "print what is rendered with, and why, for the scene's own camera, and end")
        ->group(group);
    app.add_option("--encode-threads", o.frame.encode_threads, "JPEG encoders")->group(group)->check(CLI::Range(1, 64));

    group = "Log";
    app.add_option("--log-level", o.log_level, "debug | info | warn | error")
        ->group(group)
        ->check(CLI::IsMember({"debug", "info", "warn", "error"}));
    app.add_option("--log-file", o.log_file, "instead of standard error")->group(group);

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& e) {
        return {std::nullopt, app.exit(e)};
    } catch (const CLI::ParseError& e) {
        std::cerr << "brume-server: " << e.what() << " (see brume-server --help)\n";
        return {std::nullopt, 2};
    }
    o.device.mesh_shaders = !no_mesh;
    return {std::move(o), 0};
}

Scene loadScene(const ServerOptions& o) {
    const std::filesystem::path file = findScene(o.scene, o.scene_dir);
    Scene scene = loadScene(file, o.overrides);
    RenderSettings& render = scene.render;
    if (o.method) render.method = *o.method;
    if (o.quadrature) render.quadrature = *o.quadrature;
    if (o.steps) render.steps = *o.steps;
    if (o.exposure) render.exposure = *o.exposure;
    if (o.cutoff) render.cutoff = *o.cutoff;
    if (o.shadow_size) render.shadow_size = *o.shadow_size;
    if (o.shadow_slices) render.shadow_slices = *o.shadow_slices;
    if (o.shadow_error) render.shadow_error = *o.shadow_error;
    if (o.paused) scene.simulation.paused = *o.paused;
    const std::string wrong = checkWanted(render);
    if (!wrong.empty()) throw SceneError(file.string() + ": render: " + wrong);
    return scene;
}

} // namespace brume
