// Identity: what all servers of one log must have in common.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/sim/simulation.h"

namespace brume::cluster {

struct Identity {
    std::string version; // of the program, and of what it understands by a state
    std::string scene;   // name
    uint64_t hash = 0;   // of the scene's text, of what options change in it, and of all particles at the start
};
// `simulation`: of the scene, not stepped.
Identity identityOf(const Simulation& simulation, const std::string& scene, const std::string& text,
                    const std::vector<std::string>& overrides);
// As a log's description, in one line.
std::string textOf(const Identity& identity);
// What a log with this description is of, when it is not ours: "version 0.1.0/11, while this server is ...". Empty: it
// is ours.
std::string differenceOf(const Identity& own, const std::string& description);

} // namespace brume::cluster
