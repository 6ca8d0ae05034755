// The page of `brume-bench correction`.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "common/plot.h"
#include "tools/bench/correction.h"

namespace brume::bench {
namespace {

std::string measuredText(const ErrorEstimate& e) {
    if (!e.known()) return "not known yet";
    return fmt::format("{:.2g} % ({:.2g} to {:.2g})", 100 * e.rmse, 100 * e.low, 100 * e.high);
}

std::string row(const std::string& head, const CorrectionSample& one) {
    return fmt::format("| {} | {} | {:.2g} % | {} |\n", head, one.way, 100 * one.predicted, measuredText(one.measured));
}

std::string verdict(const CorrectionRun& run, const CorrectionTimes& t) {
    const auto after = [&](const CorrectionSample& one) { return one.s - run.broken_s; };
    if (!t.above) return "The measured error never was above the budget.\n\n";
    std::string out =
        fmt::format("The measured error was first above the budget {:.1f} s after the laws turned wrong. At worst it "
                    "was {:.2g} %, after {:.1f} s. ",
                    after(*t.above), 100 * t.worst->measured.rmse, after(*t.worst));
    if (!t.within) return out + "It was not within the budget again before the run ended.\n\n";
    return out + fmt::format("**After {:.1f} s it was within the budget again.** Of the {} samples from then on {} "
                             "were above it.\n\n",
                             after(*t.within), t.after, t.after_above);
}

// Lines over the time of a run, each with its name at its first point.
class Lines {
public:
    Lines(const CorrectionRun& run, std::string title, std::string y_label)
        : plot_{.title = std::move(title),
                .x_label = "s after the laws turned wrong",
                .y_label = std::move(y_label),
                .points = {},
                .front = false,
                .joined = true,
                .linear_x = true},
          zero_(run.broken_s) {}

    void add(const char* name, int line, const CorrectionSample& at, double value, double low = 0, double high = 0) {
        const bool is_first = std::ranges::find(plot_.points, line, &Point::group) == plot_.points.end();
        plot_.points.push_back({is_first ? name : "", at.s - zero_, value, line, low, high});
    }
    std::string text() const { return svg(plot_); }

private:
    Plot plot_;
    const double zero_; // s
};

} // namespace

std::string correctionPage(const CorrectionRun& run) {
    const CorrectionTimes times = timesOf(run);
    const std::string head = "setting | predicted | measured (bounds of 95 %) |\n|---|---|---|---|\n";
    std::string out = verdict(run, times) + "| | " + head;
    if (times.before) out += row("before", *times.before);
    if (times.worst) out += row("at worst", *times.worst);
    if (times.last) out += row("at the end", *times.last);
    out += "\nEvery change of the settings; seconds count from when the laws turned wrong:\n\n| s | " + head;
    const std::string* way = nullptr;
    for (const CorrectionSample& one : run.samples) {
        if (way && *way == one.way) continue;
        way = &one.way;
        out += row(fmt::format("{:.1f}", one.s - run.broken_s), one);
    }
    return out + fmt::format("\n{} samples of {} frames.\n", run.samples.size(), run.frames);
}

std::string correctionPlot(const CorrectionRun& run) {
    Lines lines(run, "Error, with laws that turn wrong at 0 s", "relative RMSE, %");
    enum Group { kMeasured, kPredicted, kBudget };
    for (const CorrectionSample& one : run.samples) {
        const ErrorEstimate& e = one.measured;
        if (e.known()) lines.add("measured", kMeasured, one, 100 * e.rmse, 100 * e.low, 100 * e.high);
        lines.add("predicted", kPredicted, one, 100 * one.predicted);
        lines.add("render.error", kBudget, one, 100 * run.promised);
    }
    return lines.text();
}

std::string settingsPlot(const CorrectionRun& run) {
    Lines lines(run, "What the plan takes, with laws that turn wrong at 0 s", "slabs, pixels between rays");
    for (const CorrectionSample& one : run.samples) {
        lines.add("slabs", 0, one, one.slabs);
        lines.add("pixels between rays", 1, one, one.rate);
    }
    return lines.text();
}

} // namespace brume::bench
