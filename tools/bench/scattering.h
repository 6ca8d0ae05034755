// Scattering: how the models of light that scatters more than once err on random scenes, beside random paths.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/metrics.h"
#include "server/plan/cost_model.h"
#include "tools/bench/stage.h"
#include "tools/reference/tracker.h"

namespace brume::bench {

struct ScatteringQuestion {
    uint64_t seed = 1;                // seed of the first scene; the others follow
    uint32_t scenes = 40;             // number of seeds
    uint32_t width = 48;              // pixels; the height is 9/16 of it
    double noise = 0.03;              // relative standard error of the paths that is aimed at
    uint32_t paths = 4096;            // most paths of a pixel
    double seconds = 60;              // most time of one scene's paths, as the first few of them foretell
    std::filesystem::path folder;     // the scenes are written there, so that each can be opened again
    std::filesystem::path references; // folder of Truth
};

// Of the radiance of the medium's pixels, in parts of the paths' RMS and mean. The noise of the paths is taken out of
// the RMSE: 0 where it hides the error.
struct ScatteringError {
    double rmse = 0, bias = 0;
};
ScatteringError scatteringError(const RadianceImage& picture, const reference::TrackedPicture& truth,
                                std::span<const uint8_t> mask);
// The paths' own standard error, RMS of the same pixels over that of their radiance.
double noiseOf(const reference::TrackedPicture& truth, std::span<const uint8_t> mask);

inline constexpr std::array<const char*, 3> kModels{"single", "octaves", "propagation"};

// What was measured of one seed.
struct ScatteringRow {
    uint64_t seed = 0;
    std::string layout, camera;
    size_t particles = 0, objects = 0;
    double depth = 0, albedo = 0; // RandomScene::depth; mean of the particles and colours
    uint32_t paths = 0;
    double noise = 0;      // of these paths
    bool promised = false; // True: the plan predicts single scattering within render.error
    std::array<ScatteringError, kModels.size()> errors{};
    std::string why_not; // one line if nothing was measured
};
ScatteringRow scatteringRow(const gpu::Device& device, const CostModel& model, const ScatteringQuestion& question,
                            uint64_t seed);

// Markdown: errors of each model by optical depth in the scenes with a promise, and all rows.
std::string scatteringPage(std::span<const ScatteringRow> rows);

} // namespace brume::bench
