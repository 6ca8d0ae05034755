#include "server/options.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iostream>
#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/net/address.h"
#include "common/scene_limits.h"
#include "server/net/token.h"
#include "server/operate/config_file.h"
#include "server/net/token_key.h"
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

// What a reload changes; docs/operate.md says when each is felt.
const std::set<std::string> kLive{"allow-origin", "max-viewers",   "max-connections", "max-connections-per-address",
                                  "max-streams",  "max-snapshots", "max-pixels",      "max-message-bytes",
                                  "quality",      "accept-rate",   "handshake",       "idle",
                                  "pose-rate",    "input-rate",    "message-rate",    "drain-time",
                                  "drain-to",     "grace",         "frame-budget",    "log-level",
                                  "host"};

// Viewers are told this URL: it holds no user or password, and a header or a log line can carry it.
std::string checkUrl(const std::string& url) {
    const bool scheme =
        url.starts_with("http://") || url.starts_with("https://") || url.starts_with("ws://") || url.starts_with("wss://");
    const bool plain = std::all_of(url.begin(), url.end(), [](char c) { return c > ' ' && c < 0x7f && c != '@'; });
    if (url.empty() || (scheme && plain && url.size() <= 1024)) return {};
    return "allowed: a URL of http, https, ws or wss, without user and password, of 1024 characters at most";
}

// Reads the key. Who may come in when there is none is never left to chance.
void readTrust(ServerOptions& o) {
    if (!o.token_key.empty()) o.net.token_key = readTokenKey(o.token_key);
    if (o.net.tls_certificate.empty() != o.net.tls_key.empty())
        throw std::runtime_error("--tls-certificate and --tls-key belong together: give both, or neither");
    if (o.net.token_key.empty() && !o.open && !isLoopback(o.net.listen))
        throw std::runtime_error(
            fmt::format("--listen {}: other machines could do everything here; allowed: --token-key FILE for "
                        "viewers with tokens, or --open for whoever comes",
                        o.net.listen));
    if (!o.net.token_key.empty() && o.open)
        throw std::runtime_error("--open lets everyone in, --token-key does not: give one of them");
}

std::string tokenFor(net::Role role, uint32_t seconds, const std::string& name, const std::string& key) {
    if (key.empty()) throw std::runtime_error("--make-token needs --token-key FILE, the server's");
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    return net::makeToken({role, now + std::chrono::seconds(seconds), name}, key);
}

std::string checkName(const std::string& name) {
    const bool printable = std::all_of(name.begin(), name.end(), [](char c) { return c >= ' ' && c <= '~'; });
    return printable && name.size() <= net::kMostTokenName ? "" : "allowed: 64 printable ASCII characters";
}

std::string checkHost(const std::string& name) {
    const bool plain = std::all_of(name.begin(), name.end(),
                                   [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '.' || c == '_'; });
    return plain && name.size() <= 253 ? "" : "allowed: a host name without scheme and port, such as clouds.example";
}

// It ends up in a header of the page's replies, among others.
std::string checkOrigin(const std::string& origin) {
    const bool plain = std::all_of(origin.begin(), origin.end(), [](char c) { return c > ' ' && c < 0x7f && c != ';'; });
    return plain ? "" : "allowed: an origin such as https://clouds.example, or *";
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
    const char* config_from_environment = std::getenv("BRUME_CONFIG");
    const std::string config = config_from_environment ? config_from_environment : "";
    app.set_config("--config", config, "TOML file with any of these options as keys: max-viewers = 8", !config.empty())
        ->type_name("FILE");
    const auto reader = std::make_shared<ConfigFile>(app);
    app.config_formatter(reader);
    bool print_config = false;
    app.add_flag("--print-config", print_config, "print all options as they stand as such a file, and end")->configurable(false);
    std::string make_token, token_name;
    uint32_t valid_for = 3600;
    auto* const make = app.add_option("--make-token", make_token, "print a token of this role, made with --token-key, and end")
                           ->configurable(false)
                           ->check(CLI::IsMember({"viewer", "controller", "operator"}))
                           ->type_name("ROLE");
    app.add_option("--valid-for", valid_for, "of that token")
        ->configurable(false)
        ->needs(make)
        ->check(CLI::Range(1u, uint32_t(net::kLongestToken.count())))
        ->type_name("SECONDS");
    app.add_option("--token-name", token_name, "whose that token is, for the log")
        ->configurable(false)
        ->needs(make)
        ->check(CLI::Validator(checkName, "", "NAME"));
    const char* group = "Scene";
    const auto ms = [&](const char* name, std::chrono::milliseconds& value, const char* about, uint32_t least = 1) {
        app.add_option_function<uint32_t>(
               name, [&value](uint32_t v) { value = std::chrono::milliseconds(v); }, about)
            ->default_str(std::to_string(value.count()))
            ->check(CLI::Range(least, 3'600'000u))
            ->type_name("MS")
            ->group(group);
    };
    const auto rate = [&](const char* name, double& value, const char* about) {
        app.add_option(name, value, about)->check(CLI::Range(1.0, 100'000.0))->type_name("1/S")->group(group);
    };

    app.add_option("--scene", o.scene, "name of a scene, or the path of a .toml file")->group(group);
    app.add_option("--scene-dir", o.scene_dir, "folder of the scenes known by name")->group(group);
    app.add_option("--set", o.overrides, "a setting instead of the scene's, as in its file: --set medium.count=5000")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->delimiter('\n')
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
    bool paused = false;
    const CLI::Option* paused_flag =
        app.add_flag("--paused", paused, "start with the simulation paused, or not: instead of the scene's")
            ->default_str("the scene's")
            ->group(group);

    group = "Network";
    app.add_option("--listen", o.net.listen, "address; 0.0.0.0 or :: lets other machines in")->group(group);
    app.add_option("--port", o.net.port, "0 takes a free one")->group(group)->check(CLI::Range(0, 65535));
    app.add_option("--web-root", o.net.web_root, "folder of the built page")->group(group);
    app.add_option("--allow-origin", o.net.allowed_origins, "pages of this origin may connect too; * for any")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->delimiter(',')
        ->check(CLI::Validator(checkOrigin, "", "ORIGIN"))
        ->group(group);
    app.add_option("--host", o.net.hosts, "without a key: a name that requests may have in their Host header")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->delimiter(',')
        ->check(CLI::Validator(checkHost, "", "NAME"))
        ->group(group);
    app.add_option("--network-threads", o.net.threads, "threads that serve connections")->group(group)->check(CLI::Range(1, 64));

    group = "Trust";
    app.add_option("--token-key", o.token_key, "file with the secret of tokens: what a viewer may do is in its token")
        ->type_name("FILE")
        ->group(group);
    app.add_flag("--open", o.open, "without a key let other machines in: everyone who comes may do everything")->group(group);
    app.add_option("--tls-certificate", o.net.tls_certificate, "certificate chain for TLS, PEM; with --tls-key")
        ->type_name("FILE")
        ->group(group);
    app.add_option("--tls-key", o.net.tls_key, "its private key, PEM")->type_name("FILE")->group(group);

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
    app.add_option("--max-snapshots", o.net.max_snapshots, "snapshots at a time")->group(group)->check(CLI::Range(0, 1000));
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
    rate("--accept-rate", o.net.accept_rate, "connections of one address; more are turned away");
    ms("--handshake", o.net.handshake, "a connection must say what it wants within this");
    ms("--idle", o.net.idle, "a viewer that is silent for this long is closed");
    rate("--pose-rate", o.net.pose_rate, "poses of a viewer; of more the newest is shown later");
    rate("--input-rate", o.net.input_rate, "commands of a viewer; more are refused");
    rate("--message-rate", o.net.message_rate, "messages of a viewer; of more we read more slowly");

    group = "Stop";
    ms("--drain-time", o.drain, "told to stop: /readyz fails for so long while all else goes on", 0);
    app.add_option("--drain-to", o.drain_to, "URL that viewers are told to go on to")
        ->type_name("URL")
        ->check(CLI::Validator(checkUrl, "", "URL"))
        ->group(group);
    ms("--grace", o.grace, "to end what is open after that");

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
    app.add_option("--refine-moving", o.frame.refine_moving,
                   "part of it that finer pictures may take while cameras rest and the medium moves; 0: none")
        ->group(group)
        ->check(CLI::Range(0.0, 1.0));
    app.add_option("--most-frame-time", o.most_frame_ms,
                   "that a frame of all viewers may take: newcomers are told to come back later")
        ->group(group)
        ->check(CLI::Range(1.0, 60'000.0))
        ->type_name("MS");
    app.add_option("--ahead", o.ahead, "compile shaders that may be needed later: background, off, or only that and end")
        ->type_name("HOW")
        ->check(CLI::IsMember({"background", "off", "only"}))
        ->group(group);
    app.add_flag("--explain", o.explain, "print what is rendered with, and why, for the scene's own camera, and end")
        ->group(group);
    app.add_option("--encode-threads", o.frame.encode_threads, "JPEG encoders")->group(group)->check(CLI::Range(1, 64));

    group = "Log";
    app.add_option("--log-level", o.log_level, "debug | info | warn | error")
        ->group(group)
        ->check(CLI::IsMember({"debug", "info", "warn", "error"}));
    app.add_option("--log-format", o.log_format, "text | json: a JSON object a line")
        ->group(group)
        ->check(CLI::IsMember({"text", "json"}));
    app.add_option("--log-file", o.log_file, "instead of standard error")->group(group);

    group = "Record";
    app.add_option("--record", o.record, "file to write the session to: its scene and every command")->group(group);
    app.add_option("--record-limit", o.record_limit, "of that file; then the recording ends")
        ->group(group)
        ->check(CLI::Range(1u, 1'000'000u))
        ->type_name("MIB");
    app.add_option("--replay", o.replay, "recorded file to step anew, without network, checking every state; and end")
        ->group(group);
    app.add_option("--frames", o.frames, "ticks between pictures of the scene's own camera while recording or replaying; 0: none")
        ->group(group)
        ->check(CLI::Range(0, 1'000'000));
    for (CLI::Option* option : app.get_options([](const CLI::Option* one) { return one->get_configurable(); }))
        option->envname(environmentName(*option));

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& e) {
        return {std::nullopt, app.exit(e), {}, {}};
    } catch (const CLI::ParseError& e) {
        std::string complaint = reader->sourceOf(e.what()) + e.what();
        std::replace(complaint.begin(), complaint.end(), '\n', ' ');
        return {std::nullopt, 2, std::move(complaint), {}};
    }
    o.device.mesh_shaders = !no_mesh;
    if (paused_flag->count() > 0) o.paused = paused;
    if (print_config) {
        std::cout << writeConfig(app) << std::flush;
        return {std::nullopt, std::cout ? 0 : 1, {}, {}};
    }
    try {
        if (o.replay.empty() && !o.explain) readTrust(o);
        if (!make_token.empty()) {
            std::cout << tokenFor(*net::roleNamed(make_token), valid_for, token_name, o.net.token_key) << std::endl;
            return {std::nullopt, std::cout ? 0 : 1, {}, {}};
        }
    } catch (const std::exception& e) {
        return {std::nullopt, 2, e.what(), {}};
    }
    ParsedOptions parsed{std::move(o), 0, {}, {}};
    for (const CLI::Option* option : app.get_options([](const CLI::Option* one) { return one->get_configurable(); }))
        parsed.settings.push_back({option->get_single_name(), tomlOf(*option), kLive.contains(option->get_single_name())});
    return parsed;
}

std::vector<std::string> sceneOverrides(const ServerOptions& o) {
    std::vector<std::string> all = o.overrides;
    const auto add = [&](const char* key, const auto& value) {
        if (value) all.push_back(fmt::format("{}={}", key, *value));
    };
    add("render.method", o.method);
    add("render.quadrature", o.quadrature);
    add("render.steps", o.steps);
    add("render.exposure", o.exposure);
    add("render.cutoff", o.cutoff);
    add("render.shadow_size", o.shadow_size);
    add("render.shadow_slices", o.shadow_slices);
    add("render.shadow_error", o.shadow_error);
    add("simulation.paused", o.paused);
    return all;
}

Scene loadScene(const ServerOptions& o) {
    const std::filesystem::path file = findScene(o.scene, o.scene_dir);
    Scene scene = loadScene(file, sceneOverrides(o));
    const std::string wrong = checkWanted(scene.render);
    if (!wrong.empty()) throw SceneError(file.string() + ": render: " + wrong);
    return scene;
}

} // namespace brume
