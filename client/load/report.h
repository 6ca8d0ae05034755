// What was measured, for programs, for people and for the eye.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "client/load/options.h"
#include "client/load/run.h"

namespace brume::load {

struct Report {
    std::string server, scene, device; // as the server says
    uint16_t width = 0, height = 0;    // granted
    std::string machine;               // cores and load average before the first run
    std::vector<Run> runs;
    std::vector<std::string> broken; // budgets, one line each
};

// The line of one run, and the lines above it: a Markdown table.
std::string tableHead();
std::string tableLine(const Run& run);

// All of it in Markdown, with what else is known of costs against viewers when there is a run of one viewer.
std::string markdown(const Report& report, const Options& options);
nlohmann::json json(const Report& report, const Options& options);
// Cost of a viewer against the number of viewers, both logarithmic; an SVG.
std::string plot(const Report& report);

// Makes the folder and proves that it can be written to; nothing for an empty path. Throws std::runtime_error, one line.
void prepareFolder(const std::filesystem::path& folder);
// load.json, load.md, load.svg. Throws std::runtime_error, one line.
void write(const Report& report, const Options& options);

} // namespace brume::load
