// A bound on what a run measures: "fps>=15@16" holds if each of 16 viewers gets 15 frames a second or more.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/load/run.h"

namespace brume::load {

struct Budget {
    std::string text;         // as the user wrote it
    double (*of)(const Run&); // the measured value
    bool at_least;            // true: >=, false: <=
    double bound;
    std::optional<uint32_t> viewers; // number of viewers of the runs that it bounds; none: of all runs
};

// Reads METRIC>=VALUE or METRIC<=VALUE, then @VIEWERS or nothing. Throws std::invalid_argument: one line that says
// what is allowed.
Budget parseBudget(const std::string& text);

// One line if the budget does not hold for this run or its value was not measured. Empty if it holds, or is about
// another number of viewers.
std::string broken(const Budget& budget, const Run& run);

} // namespace brume::load
