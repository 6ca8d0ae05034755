// Writes what was measured: as JSON, as Markdown and as a plot.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "client/load/options.h"
#include "client/load/run.h"

namespace brume::load {

struct Report {
    std::string server, scene, device; // from the server's welcome
    uint16_t width = 0, height = 0;    // pixels of one eye's picture, as the server granted
    std::string machine;               // cores and load average before the first run
    std::vector<Run> runs;
    std::vector<std::string> broken; // one line for each budget that does not hold, and each run with unequal ticks
};

// A Markdown table: its head, and the line of one run.
std::string tableHead();
std::string tableLine(const Run& run);

// The whole report in Markdown. With a run of one viewer it compares costs per viewer with published ones
// (published.h).
std::string markdown(const Report& report, const Options& options);
nlohmann::json json(const Report& report, const Options& options);
// Cost of a viewer against the number of viewers, both logarithmic; an SVG.
std::string plot(const Report& report);

// Creates the folder and checks that it can be written to; does nothing for an empty path. Throws std::runtime_error,
// one line.
void prepareFolder(const std::filesystem::path& folder);
// Writes load.json, load.md and load.svg. Throws std::runtime_error, one line.
void write(const Report& report, const Options& options);

} // namespace brume::load
