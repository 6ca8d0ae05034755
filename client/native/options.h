// The options of the command line, checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "client/native/camera_path.h"
#include "client/native/endpoint.h"
#include "client/native/session.h"

namespace brume::client {

struct TimedImpulse {
    double seconds = 0; // after the first frame
    Impulse impulse;
};

struct Options {
    std::vector<Endpoint> servers{{"127.0.0.1", 8080, "/ws"}}; // one at least; the next is tried when one is lost
    Wishes wishes;
    bool draw = false;                // true: pictures are drawn here, from lit particles
    bool redraw = false;              // true: the window redraws pictures where its camera is by now
    bool headless = false;            // true: no window
    uint64_t frames = 0;              // stop after so many frames; 0: no limit
    double seconds = 0;               // stop so long after the first frame; 0: no limit
    double timeout = 10;              // s without a frame, or for connecting, before the connection counts as lost
    bool reconnect = true;            // true: connect again when the connection is lost
    std::filesystem::path out;        // folder for statistics and pictures, or a film; empty: write nothing
    bool film = false;                // true: `out` is a film or numbered pictures of one
    bool save = true;                 // true: write the pictures too
    std::optional<CameraPath> camera; // replaces the scene's own camera; its kind is `path`
    PathKind path = PathKind::still;
    std::shared_ptr<const KeyPath> keys; // key views of a file; null: the scene's own
    uint32_t fps = 30;                   // frames a second of a film
    std::vector<TimedImpulse> impulses;  // sorted by time
    bool pause = false;                  // true: pauses the scene, for everybody, before the first picture
};

constexpr uint8_t kDrawHz = 30;          // messages a second, of a client that draws
constexpr float kEyeSeparation = 0.064f; // m, the mean of adults

// Nothing if the program is to end: then `exit_code` is set and the text is printed (help, version, or one line that
// says what is wrong).
std::optional<Options> parseOptions(int argc, const char* const* argv, int& exit_code);

} // namespace brume::client
