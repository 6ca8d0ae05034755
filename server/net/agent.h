// What HAProxy's agent-check is told of this server.
#pragma once

#include <cstdint>
#include <string>

namespace brume::net {

struct Load {
    bool ready, draining;     // as /readyz
    bool stands;              // True: no ticks come at present
    float budget_used;        // what a frame of all viewers takes of the device, over the frame budget
    uint32_t viewers, places; // who is in, and how many may be
};

// One line. A server that drains gets no new viewers and keeps its own: "drain". One that cannot draw is "down".
// Otherwise the weight is the part of the frame budget or of the places that is free, whichever is less, at least 1 %,
// and 1 % of one that stands still:
// "up ready 75%". "up" ends an earlier "down", and "ready" an earlier "drain".
std::string agentLine(const Load& load);

} // namespace brume::net
