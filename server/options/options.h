// Options of brume-server. A flag overrides an environment variable (BRUME_*), which overrides the TOML file.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "common/scene.h"
#include "server/cluster/options.h"
#include "server/frame/frame_options.h"
#include "server/gpu/device.h"
#include "server/net/options.h"

namespace brume {

struct ServerOptions {
    std::string scene = "plume";
    std::filesystem::path scene_dir;    // folder of the scenes that are known by name
    std::filesystem::path cloud_dir;    // folder of uploaded point clouds
    std::vector<std::string> overrides; // key=value, replaces the scene's value
    net::NetOptions net;
    std::vector<std::string> rooms;           // NAME=SCENE, at /r/NAME/ besides the scene at /
    uint32_t max_rooms = 8;                   // besides the one at /
    std::string idle_rooms = "tick";          // what rooms do that nobody looks at: tick | sleep
    std::vector<std::string> trusted_proxies; // as they are given; read, they are in `net`
    std::filesystem::path token_key;          // file of the key; its bytes are in `net`
    bool open = false;                        // True: serves other machines without a key
    uint32_t max_viewers = 32;
    uint32_t max_in_flight = 6;
    uint32_t max_drawing_viewers = 1000;
    uint32_t max_viewers_per_owner = 24; // of one address, or one token's name
    gpu::DeviceOptions device;
    FrameOptions frame;
    // Replace the scene's values if set.
    std::optional<std::string> method;
    std::optional<bool> paused;
    cluster::ClusterOptions cluster;
    std::filesystem::path costs;      // folder of cost files, written by brume-bench calibrate
    bool explain = false;             // True: print the plan and exit
    std::string ahead = "background"; // compile shaders ahead: background | off | only
    std::string log_level = "info", log_format = "text";
    std::filesystem::path log_file;        // empty: standard error
    std::chrono::milliseconds drain{0};    // time after a stop signal with /readyz failing and frames flowing
    std::string drain_to;                  // URL that viewers are sent to when the server stops; empty: none
    std::chrono::milliseconds grace{3000}; // then the time in which connections may close
    std::filesystem::path record, replay;  // files; empty: none
    uint32_t record_limit = 256;           // MiB
    uint32_t frames = 0;                   // recording, replay: ticks between pictures of the scene's camera; 0: none
    bool look = false;                     // True: viewers look at the replay
    std::filesystem::path out;             // folder for a film of the replay; empty: none
    std::string format = "jpeg";           // of its pictures: jpeg | png
    uint32_t fps = 30;                     // of the film
    uint32_t height = 720;                 // pixels of the film, 16:9
};

// The present value of one option.
struct Setting {
    std::string name;  // its key in the TOML file
    std::string value; // as TOML
    bool live;         // True: reload() can change it
};

// The result of parsing: options, or the exit code if the program ends here. It ends after --help, --version or
// --print-config, which have printed, and after a mistake.
struct ParsedOptions {
    std::optional<ServerOptions> options;
    int exit_code = 0;
    std::string complaint;         // one line on the mistake: where it is, what is wrong, what is allowed
    std::vector<Setting> settings; // the values of all options
};
ParsedOptions parseServerOptions(int argc, const char* const* argv);

// Scene settings given by options, as key=value.
std::vector<std::string> sceneOverrides(const ServerOptions& options);
// Those of them that every scene can have: all but --set.
std::vector<std::string> rendererOverrides(const ServerOptions& options);
// Throws SceneError if the scene asks for something that this server cannot draw. It names the file, or the option if
// one of the overrides asks for it.
void checkScene(const Scene& scene, const std::filesystem::path& file, std::span<const std::string> overrides = {});
// Loads the scene with these settings. Throws SceneError.
Scene loadScene(const ServerOptions& options);

} // namespace brume
