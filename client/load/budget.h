// What a run must keep: "fps>=15@16" says that with 16 viewers each gets 15 frames a second or more.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/load/run.h"

namespace brume::load {

struct Budget {
    std::string text; // as written
    double (*of)(const Run&);
    bool at_least; // else at most
    double bound;
    std::optional<uint32_t> viewers; // of all runs when it names none
};

// METRIC>=VALUE or METRIC<=VALUE, then @VIEWERS or nothing. Throws std::invalid_argument: one line that says what is allowed.
Budget parseBudget(const std::string& text);

// One line when the run does not keep it, or when what it is about was not measured; empty otherwise, also when the budget is
// about another number of viewers.
std::string broken(const Budget& budget, const Run& run);

} // namespace brume::load
