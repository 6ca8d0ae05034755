// What brume-server may be asked: by flags, by the environment (BRUME_*) and by a TOML file, in this order.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/scene.h"
#include "server/frame_options.h"
#include "server/gpu/device.h"
#include "server/net/options.h"

namespace brume {

struct ServerOptions {
    std::string scene = "plume";
    std::filesystem::path scene_dir;    // of the scenes that are known by name
    std::vector<std::string> overrides; // key=value, instead of the scene's
    net::NetOptions net;
    std::filesystem::path token_key; // its bytes are in `net`
    bool open = false;               // without a key, whoever may reach it
    uint32_t max_viewers = 32;
    uint32_t max_in_flight = 6;
    float most_frame_ms = 500; // of all viewers
    gpu::DeviceOptions device;
    FrameOptions frame;
    // Instead of the scene's own.
    std::optional<std::string> method, quadrature;
    std::optional<uint32_t> steps, shadow_size, shadow_slices;
    std::optional<float> exposure, cutoff, shadow_error;
    std::optional<bool> paused;
    std::filesystem::path costs;      // folder of the device's constants, as brume-bench calibrate writes them
    bool explain = false;             // print the plan and end
    std::string ahead = "background"; // compile shaders ahead: so, off, or only that
    std::string log_level = "info", log_format = "text";
    std::filesystem::path log_file;        // empty: standard error
    std::chrono::milliseconds drain{0};    // told to stop: /readyz fails for so long while frames still flow
    std::string drain_to;                  // URL that viewers are told to go on to; empty: none
    std::chrono::milliseconds grace{3000}; // to end what is open after that
    std::filesystem::path record, replay;  // files; empty: none
    uint32_t record_limit = 256;           // MiB
    uint32_t frames = 0;                   // recording and replaying: ticks between pictures of the scene's own camera
};

// One option as it stands.
struct Setting {
    std::string name;  // its key in the file
    std::string value; // as TOML
    bool live;         // a reload can change it
};

// Options, or the exit code of a command line that ends here: --help, --version and --print-config, which have printed, or a
// mistake.
struct ParsedOptions {
    std::optional<ServerOptions> options;
    int exit_code = 0;
    std::string complaint;         // one line on the mistake: where it is, what is wrong, what is allowed
    std::vector<Setting> settings; // of all options
};
ParsedOptions parseServerOptions(int argc, const char* const* argv);

// The options' settings of the scene, as in its file: key=value.
std::vector<std::string> sceneOverrides(const ServerOptions& options);
// The scene with these in it. Throws SceneError.
Scene loadScene(const ServerOptions& options);

} // namespace brume
