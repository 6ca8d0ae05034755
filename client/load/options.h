// The options of the command line, checked.
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

inline constexpr uint32_t kMostViewers = 1000;

// How a viewer's camera moves, and with how many eyes.
struct Path {
    client::PathKind kind = client::PathKind::orbit;
    bool stereo = false; // true: two eyes
};

struct Options {
    std::vector<uint32_t> viewers{1, 2, 4, 8, 16, 32}; // numbers of viewers; one run for each
    double seconds = 10, warm_up = 2;                  // lengths of each run and of the time before it
    double timeout = 30;                               // s without a frame, or for connecting, until it gives up
    std::vector<Path> paths{Path{}};                   // given to the viewers in turn
    client::Wishes wishes;
    uint8_t layers = 0;                        // with depth, that viewers ask for: they are to redraw pictures
    bool decode = false;                       // true: the pictures are decoded too, and particles unpacked
    bool reconnect = false;                    // true: a viewer whose connection ends connects again
    std::vector<client::Endpoint> servers;     // running servers, all different; empty: one is started
    bool follow = false;                       // true: all follow the first viewer's camera
    bool anywhere = false;                     // true: other machines may be loaded
    double push = 0;                           // pushes a second of each viewer
    uint64_t seed = 1;                         // seed of the places where viewers push
    std::vector<std::string> server_arguments; // arguments for a server that is started here
    std::filesystem::path out;                 // folder for the results; empty: nothing is written
    std::vector<Budget> budgets;
};

// Nothing if the program is to end: then `exit_code` is set and the text is printed (help, version, or one line that
// says what is wrong).
std::optional<Options> parseOptions(int argc, const char* const* argv, int& exit_code);

} // namespace brume::load
