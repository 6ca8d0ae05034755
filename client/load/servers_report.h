// The part of the report that is about each server by itself, and about whether they agree.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "client/load/options.h"
#include "client/load/run.h"

namespace brume::load {

// True: each server is told by itself, since there are several or viewers push.
bool tellsServers(const Options& options);

// A Markdown table with a line for each server and run, then what is to be said of each run: how many ticks were equal,
// and how long viewers were away.
std::string serversText(const std::vector<Run>& runs);
// What a run adds to its JSON.
nlohmann::json serversJson(const Run& run);

// One line if two servers told different states of one tick; empty otherwise.
std::string differenceLine(const Run& run);

} // namespace brume::load
