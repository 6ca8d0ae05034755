// What brume-server may be asked on its command line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/scene.h"
#include "server/frame.h"
#include "server/gpu/device.h"
#include "server/net/options.h"

namespace brume {

struct ServerOptions {
    std::string scene = "plume";
    std::filesystem::path scene_dir;    // of the scenes that are known by name
    std::vector<std::string> overrides; // key=value, instead of the scene's
    net::NetOptions net;
    uint32_t max_viewers = 32;
    uint32_t max_in_flight = 6;
    float most_frame_ms = 500; // of all viewers
    gpu::DeviceOptions device;
    FrameLoop::Options frame;
    // Instead of the scene's own.
    std::optional<std::string> method, quadrature;
    std::optional<uint32_t> steps, shadow_size, shadow_slices;
    std::optional<float> exposure, cutoff, shadow_error;
    std::optional<bool> paused;
    std::filesystem::path costs; // folder of the device's constants, as brume-bench calibrate writes them
    bool explain = false;        // print the plan and end
    std::string log_level = "info";
    std::filesystem::path log_file;        // empty: standard error
    std::chrono::milliseconds grace{3000}; // to end what is open when told to stop
};

// Options, or the exit code of a command line that ends here (--help, --version, a mistake: one line on standard error).
struct ParsedOptions {
    std::optional<ServerOptions> options;
    int exit_code = 0;
};
ParsedOptions parseServerOptions(int argc, const char* const* argv);

// The scene with the command line's settings in it. Throws SceneError.
Scene loadScene(const ServerOptions& options);

} // namespace brume
