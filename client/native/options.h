// What the user asked for on the command line, checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "client/native/camera_path.h"
#include "client/native/endpoint.h"
#include "client/native/session.h"

namespace brume::client {

struct TimedPush {
    double seconds = 0; // after the first frame
    Push push;
};

struct Options {
    Endpoint endpoint{"127.0.0.1", 8080, "/ws"};
    Wishes wishes;
    bool headless = false;
    uint64_t frames = 0;              // stop after so many; 0 = do not
    double seconds = 0;               // stop so long after the first frame; 0 = do not
    double timeout = 10;              // s without a frame, or for connecting
    bool reconnect = true;            // when the connection is lost
    std::filesystem::path out;        // empty = write nothing
    bool save = true;                 // JPEG files too
    std::optional<CameraPath> camera; // kind is always `path`
    PathKind path = PathKind::still;
    std::vector<TimedPush> pushes; // by time
};

constexpr float kEyeSeparation = 0.064f; // m, the mean of adults

// Nothing when the program is done: `exit_code` is set and what there was to say is printed (help, version, or one line
// on what is wrong).
std::optional<Options> parseOptions(int argc, const char* const* argv, int& exit_code);

} // namespace brume::client
