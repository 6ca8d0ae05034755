// What measuring makes of laws that turn wrong while the server's frame loop draws for a viewer.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "server/error/error_window.h"
#include "server/plan/cost_model.h"
#include "tools/bench/stage.h"

namespace brume::bench {

// What is known at one moment, of the newest pictures.
struct CorrectionSample {
    double s = 0;    // after the first measured error
    std::string way; // the plan's method and settings, for people
    double rate = 0; // pixels between rays
    double slabs = 0;
    double predicted = 0;   // relative RMSE, as the plan corrects it
    ErrorEstimate measured; // error of the newest pixels; its law is as wrong as the laws are
};

struct CorrectionRun {
    double promised = 0; // render.error
    double broken_s = 0; // when the laws turned wrong
    uint64_t frames = 0; // frames that the viewer got
    std::vector<CorrectionSample> samples;
};

struct CorrectionQuestion {
    Case wanted;                 // its viewer flies slowly around the scene's target
    double law_factor = 0.25;    // on the error of every law, from `at` on
    double at = 20;              // s after the first measured error. A command makes the plan anew then
    double seconds = 60;         // s after it at which the run ends; more than `at`
    double measure_error = 0.02; // FrameOptions::measure_error
    std::function<bool(const CorrectionRun&)> done; // true ends the run before that; may be empty
};

// Takes a sample each half second. Throws SceneError for a scene that promises nothing, std::runtime_error if nothing
// is measured within a minute or a frame does not come.
CorrectionRun correctionRun(const gpu::Device& device, const CostModel& costs, const CorrectionQuestion& question);

// What a run says of the time after the laws turned wrong.
struct CorrectionTimes {
    const CorrectionSample* before = nullptr; // the last one with a measured error
    const CorrectionSample* above = nullptr;  // the first above the budget; null: none
    const CorrectionSample* worst = nullptr;  // the largest measured error
    const CorrectionSample* within = nullptr; // the first within the budget after `above`; null: none
    const CorrectionSample* last = nullptr;   // the last one with a measured error
    size_t after = 0, after_above = 0;        // samples from `within` on; those above the budget
};
CorrectionTimes timesOf(const CorrectionRun& run);

// Markdown: when the error was above the budget and when no longer, and every change of the settings.
std::string correctionPage(const CorrectionRun& run);
// Measured and predicted error over time, as SVG.
std::string correctionPlot(const CorrectionRun& run);
// Slabs and pixels between rays over time, as SVG.
std::string settingsPlot(const CorrectionRun& run);

} // namespace brume::bench
