// What the user asked for on the command line, checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/load/budget.h"
#include "client/native/camera_path.h"
#include "client/native/endpoint.h"
#include "client/native/session.h"

namespace brume::load {

inline constexpr uint32_t kMostViewers = 256;

// Where a viewer goes and with how many eyes.
struct Path {
    client::PathKind kind = client::PathKind::orbit;
    bool stereo = false;
};

struct Options {
    std::vector<uint32_t> viewers{1, 2, 4, 8, 16, 32}; // of one run each
    double seconds = 10, warm_up = 2;                  // of each run
    double timeout = 30;                               // s without a frame, or for connecting
    std::vector<Path> paths{Path{}};                   // viewers take them in turn
    client::Wishes wishes;
    bool decode = false;
    bool reconnect = false;                    // viewers whose connection ends come back
    std::optional<client::Endpoint> server;    // one that runs already; else one is started:
    std::vector<std::string> server_arguments; // of the started one
    std::filesystem::path out;                 // empty: write nothing
    std::vector<Budget> budgets;
};

// Nothing when the program is done: `exit_code` is set and what there was to say is printed (help, version, or one line
// on what is wrong).
std::optional<Options> parseOptions(int argc, const char* const* argv, int& exit_code);

} // namespace brume::load
