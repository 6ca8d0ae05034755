// Runs series of measurements. A series combines scenes, cameras, sizes, viewers and variants. They are timed in
// turns and compared with the double-precision reference.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "server/gpu/device.h"
#include "tools/bench/motion.h"
#include "tools/bench/stage.h"
#include "tools/bench/truth.h"

namespace brume::bench {

struct Variant {
    std::string name;
    std::vector<std::string> set;
    std::string size;         // size of its pictures; empty: the series' sizes
    uint32_t lights = 0;      // how many of the scene's lights there are, the first ones; 0: all
    bool mesh_shaders = true; // True: if the device has them; kind cost
    double published_ms = 0;  // the dissertation's figure; 0: none was published
};

struct Series {
    std::string name, about;
    std::string kind = "cost"; // cost | jpeg | light | phase | seams | motion | parts
    std::vector<std::string> scenes, cameras{"outside"}, sizes{"640x360"}, viewers{"1"};
    std::vector<std::string> set; // for all variants
    Stand stand;                  // of the viewers
    uint32_t ticks = 0;           // simulated before the first frame
    bool moving = false;          // True: each frame is of the next tick, and knows what the one before has made
    std::string error;            // size of the pictures whose error is measured; empty: no errors
    uint32_t every = 1;           // errors: only every so many-th pixel is compared; odd, divides the size
    bool ground = false;  // True: also what the sun leaves on the ground, beside the reference; needs a union of balls
    std::string baseline; // variant that the report compares the others with; empty: the first
    std::string published_on; // device of the published figures
    std::vector<Variant> variants;
    std::vector<std::string> qualities; // kind jpeg: JPEG qualities
    // Kind cost: variant beside whose pictures the others are measured, too. Kind motion: the one that is the truth.
    std::string beside;
    Motion motion; // kind motion
};

struct Effort {
    double seconds = 1;                        // time for the frames of each variant
    uint32_t least = 3;                        // least frames of each variant
    std::string only;                          // part of the series' names; empty: all series
    const gpu::Device* without_mesh = nullptr; // device that lacks them; null: no variant asks for it
};

// A variant in one place. `medium_alone`: without sky and ambient light, as errors are measured.
Case caseOf(const Series& series, const Variant& variant, const std::string& scene, const std::string& camera,
            bool medium_alone);

// Loads a sweep. Throws SceneError, which names file, line, key and what is allowed.
std::vector<Series> loadSweep(const std::filesystem::path& file);

// Runs a sweep and returns its results. Reports progress on standard error.
nlohmann::json runSweep(const gpu::Device& device, const std::vector<Series>& all, Truth& truth, const Effort& effort);

} // namespace brume::bench
