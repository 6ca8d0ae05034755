// Promise: whether `auto` keeps its promised error on random scenes, which nobody tuned it for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/plan/cost_model.h"
#include "tools/bench/stage.h"
#include "tools/random_scene/random_scene.h"

namespace brume::bench {

struct PromiseQuestion {
    uint64_t seed = 1;    // of the first scene; the others follow
    uint32_t scenes = 60; // number of seeds
    RandomKind kind = RandomKind::sun;
    std::string method = "auto";  // render.method
    double budget = 0.005;        // render.error
    double flip = 0.01;           // render.flip
    uint32_t pixels = 1500;       // compared, at most
    double seconds = 8;           // of the reference of one scene, after its first pixels
    bool price = false;           // True: also looks for the cheapest way that holds the budget
    bool parts = false;           // True: also measures what each part of the chosen way errs
    bool whole = false;           // True: also measures FLIP, against the whole picture by finer settings
    std::filesystem::path folder; // the scenes are written there, so that each can be opened again
};

// What was measured of one seed: flat but for "parts". A scene that could not be measured has "why_not", one line.
nlohmann::json promiseRow(const gpu::Device& device, const CostModel& model, const PromiseQuestion& question,
                          uint64_t seed);

// Rows of earlier runs, one JSON object a line; none where the file is missing. Throws std::runtime_error with file
// and line for anything else, and for rows of another budget or kind.
std::vector<nlohmann::json> readRows(const std::filesystem::path& file, double budget,
                                     RandomKind kind = RandomKind::sun);
inline const char* nameOf(RandomKind kind) { return kind == RandomKind::lit ? "lit" : "sun"; }

// Measures the seeds that `file` does not have yet, and appends a row for each. Returns the rows of all seeds asked
// for.
std::vector<nlohmann::json> measureRows(const gpu::Device& device, const CostModel& model,
                                        const PromiseQuestion& question, const std::filesystem::path& file);

} // namespace brume::bench
