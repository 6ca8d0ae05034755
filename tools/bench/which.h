// Which method renders a scene within an error for the least time: predicted for all, measured for the promising.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/plan/cost_model.h"
#include "tools/bench/stage.h"

namespace brume::bench {

struct Question {
    Case wanted;         // the medium is measured without sky and ambient light, whatever the scene has
    double error = 0.01; // relative RMSE of the medium's pixels without edges, docs/conventions.md
    uint32_t ticks = 0;  // simulated first
    double seconds = 30; // begins no measurement later than this
};

// One way to render.
struct Answer {
    std::string method;
    std::string text;                // settings in a few words, for people
    std::vector<std::string> set;    // "render.rate=8" and so on, against the scene's
    std::optional<double> predicted; // relative RMSE; none: the method's error is not predicted
    double predicted_ms = 0;         // of a view and of what all share
    bool measured = false;           // False: `why_not` says why
    std::string why_not;
    double error = 0, uncertainty = 0;       // relative RMSE; its standard error by sampling pixels
    std::string edges;                       // the error at edges, for people
    double view_ms = 1e30, shared_ms = 1e30; // least of some frames

    double ms() const { return view_ms + shared_ms; }
    // True: holds `most` even if the error is two standard errors larger.
    bool holds(double most) const { return measured && error + 2 * uncertainty <= most; }
};

struct Answers {
    std::vector<Answer> all; // the best of each method, by time; then those that were not measured
    std::optional<size_t>
        best;           // in `all`: the cheapest that holds, otherwise the most accurate; none: none was measured
    bool holds = false; // True: `best` is within the error
    // True: the scene has light that scatters more than once. It is left out, as the reference scatters once.
    bool scatters_on = false;
    size_t pixels = 0, edge_pixels = 0; // compared
    std::string refused;                // "METHOD: reason" for a method that the scene does not allow
    double seconds = 0;                 // that it took
};

// "render.rate=8" and so on: where `to` is not `from`.
std::vector<std::string> changes(RenderSettings from, RenderSettings to);

// Throws SceneError, or std::runtime_error if the camera sees no medium. Tells progress on standard error.
Answers which(const gpu::Device& device, const CostModel& model, const Question& question);

// Markdown: a head, a table, and lines of TOML for the best.
std::string whichText(const Question& question, const Answers& answers);
// What the columns mean, a paragraph of Markdown.
std::string whichLegend();

} // namespace brume::bench
