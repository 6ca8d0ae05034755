// Runs a list of series: every combination of scenes, cameras, sizes, viewers and variants, timed in turns and compared with the
// double-precision reference.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "server/gpu/device.h"
#include "tools/bench/truth.h"

namespace brume::bench {

struct Variant {
    std::string name;
    std::vector<std::string> set;
    std::string size;        // of its pictures; empty: the series' sizes
    double published_ms = 0; // the dissertation's own figure for it, 0: it prints none
};

struct Series {
    std::string name, about;
    std::string kind = "cost"; // cost | jpeg | light | orbit
    std::vector<std::string> scenes, cameras{"outside"}, sizes{"640x360"}, viewers{"1"};
    std::vector<std::string> set; // for all variants
    std::string error;            // size of the pictures whose error is measured; empty: none is
    uint32_t every = 1;           // of those, only every so many-th pixel is compared, an odd number that divides the size
    std::string baseline;         // the variant that the report relates the others to; empty: the first
    std::string published_on;     // the device of the variants' published figures
    std::vector<Variant> variants;
    std::vector<std::string> qualities; // jpeg
    uint32_t frames = 0;                // orbit
    float degrees = 0;                  // orbit, per frame
};

struct Effort {
    double seconds = 1; // of frames per variant
    uint32_t least = 3; // frames per variant
    std::string only;   // part of a series' name; empty: all
    uint32_t ticks = 0; // of simulation before the first frame
};

// Throws SceneError: file, line, key and what is allowed.
std::vector<Series> loadSweep(const std::filesystem::path& file);

// Says on standard error what it is doing.
nlohmann::json runSweep(const gpu::Device& device, const std::vector<Series>& all, Truth& truth, const Effort& effort);

} // namespace brume::bench
