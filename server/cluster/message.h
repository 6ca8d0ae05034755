// Messages of the log that all servers of a cluster follow. Each is one line of JSON.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "server/sim/command.h"

namespace brume::cluster {

// A viewer's command. A server numbers its own from 1 on.
struct NodeCommand {
    std::string node; // who published it
    uint64_t number = 0;
    Command command; // its viewer stays with that server
};
// Ticks go on to this one.
struct Advance {
    std::string node;
    uint64_t tick = 0;
};
// A server is there, and had this state.
struct Here {
    std::string node;
    uint64_t tick = 0, hash = 0; // Simulation::tick() and stateHash()
    std::string url;             // where viewers reach it; empty: nobody is sent there
    double load = 0;             // part of its time for frames that is used, or of its places
    bool takes = false;          // True: it has room for more viewers
};
using LogMessage = std::variant<NodeCommand, Advance, Here>;

std::string pack(const LogMessage& message);
// Nothing: no message of ours. Every server of one version decides so alike.
std::optional<LogMessage> unpack(std::string_view text);

} // namespace brume::cluster
