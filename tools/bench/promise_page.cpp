#include "tools/bench/promise_page.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "common/plot.h"
#include "tools/bench/stage.h"

namespace brume::bench {
namespace {

using nlohmann::json;

constexpr size_t kWorst = 12; // rows of the table of the worst

bool isMeasured(const json& row) { return row.contains("measured"); }
double number(const json& row, const char* key) { return row.at(key).get<double>(); }
std::string text(const json& row, const char* key) { return row.at(key).get<std::string>(); }

// Scenes whose number is in one of a few bands.
struct Bands {
    const char* key;
    std::vector<double> ends; // the last band has none
    std::string operator()(const json& row) const {
        const double value = number(row, key);
        for (size_t i = 0; i < ends.size(); ++i)
            if (value < ends[i])
                return i == 0 ? fmt::format("below {}", ends[0]) : fmt::format("{} to {}", ends[i - 1], ends[i]);
        return fmt::format("{} and more", ends.back());
    }
};

struct Group {
    std::vector<double> measured, ratio;
    size_t within = 0, nearly = 0;
    void add(const json& row, double budget) {
        const double error = number(row, "measured");
        measured.push_back(error), ratio.push_back(error / std::max(number(row, "predicted"), 1e-9));
        within += error <= budget, nearly += error <= 1.5 * budget;
    }
    std::string cells() const {
        const double all = double(measured.size()) / 100;
        return fmt::format("{} | {:.0f} % | {:.0f} % | {:.2f} | {:.3g} % | {:.3g} %", measured.size(),
                           double(within) / all, double(nearly) / all, median(ratio), 100 * median(measured),
                           100 * percentile(measured, 1));
    }
};

// A table of one line for each value of `of`, in their order by number, then by name.
std::string table(std::span<const json> rows, double budget, const char* head,
                  const std::function<std::string(const json&)>& of, const char* order = nullptr) {
    std::map<std::string, Group> groups;
    std::map<std::string, double> least;
    for (const json& row : rows) {
        if (!isMeasured(row)) continue;
        const std::string name = of(row);
        groups[name].add(row, budget);
        const double at = order ? number(row, order) : 0;
        least[name] = least.contains(name) ? std::min(least[name], at) : at;
    }
    std::vector<std::string> names;
    for (const auto& [name, group] : groups) names.push_back(name);
    std::ranges::stable_sort(names, {}, [&](const std::string& name) { return least[name]; });
    std::string out = fmt::format("| {} | scenes | within {:.3g} % | within {:.3g} % | measured / predicted, median | "
                                  "measured, median | worst |\n|---|---|---|---|---|---|---|\n",
                                  head, 100 * budget, 150 * budget);
    for (const std::string& name : names) out += fmt::format("| {} | {} |\n", name, groups[name].cells());
    return out + '\n';
}

// Of rows that count fogs and local lights.
std::string litTables(std::span<const json> rows, double budget) {
    std::string out = table(rows, budget, "fogs", [](const json& row) { return row.at("fogs").dump(); });
    out += table(rows, budget, "points and spots", [](const json& row) { return row.at("local_lights").dump(); });
    std::vector<json> promised;
    std::ranges::copy_if(rows, std::back_inserter(promised),
                         [](const json& row) { return isMeasured(row) && row.at("promised").get<bool>(); });
    const auto has = [](const json& row, const char* key) { return number(row, key) > 0; };
    return out + "Views in which the plan promises the budget:\n\n" +
           table(promised, budget, "promised views with", [&](const json& row) {
               const bool fog = has(row, "fogs"), lights = has(row, "local_lights");
               return fog && lights ? "fogs and local lights"
                      : fog         ? "fogs"
                      : lights      ? "local lights"
                                    : "the sun alone";
           });
}

std::string worstTable(std::vector<json> rows) {
    std::erase_if(rows, [](const json& row) { return !isMeasured(row); });
    std::ranges::sort(rows, std::greater{}, [](const json& row) { return number(row, "measured"); });
    rows.resize(std::min(rows.size(), kWorst));
    std::string out = "| seed | scene | way | predicted | measured | bias |\n|---|---|---|---|---|---|\n";
    for (const json& row : rows)
        out += fmt::format(
            "| {} | {}, {} particles, depth {:.2g}, {}, {}x{} | {} | {:.2g} % | {:.3g} % ± {:.1g} | {:.2g} % |\n",
            row.at("seed").get<uint64_t>(), text(row, "layout"), row.at("count").get<uint64_t>(), number(row, "depth"),
            text(row, "camera"), row.at("width").get<uint32_t>(), row.at("height").get<uint32_t>(), text(row, "way"),
            100 * number(row, "predicted"), 100 * number(row, "measured"), 200 * number(row, "standard_error"),
            100 * number(row, "bias"));
    return out + '\n';
}

std::string priceLine(std::span<const json> rows) {
    std::vector<double> ratios;
    size_t none = 0;
    for (const json& row : rows) {
        if (!isMeasured(row)) continue;
        if (row.contains("cheapest_ms"))
            ratios.push_back(number(row, "ms") / number(row, "cheapest_ms"));
        else
            ++none;
    }
    if (ratios.empty()) return {};
    return fmt::format("Time of the chosen way over that of the cheapest way tried that held: median {:.2f} of {} "
                       "scenes. In {} no way was tried that held, or none was looked for.\n\n",
                       median(ratios), ratios.size(), none);
}

std::string flipLine(std::span<const json> rows, double flip) {
    std::vector<double> ratios, finest;
    size_t within = 0, promised = 0, held = 0;
    for (const json& row : rows) {
        if (!isMeasured(row) || !row.contains("flip")) continue;
        const bool holds = number(row, "flip") <= flip, promises = number(row, "predicted_flip") <= flip;
        within += holds, promised += promises, held += holds && promises;
        ratios.push_back(number(row, "flip") / std::max(number(row, "predicted_flip"), 1e-9));
        finest.push_back(number(row, "finest"));
    }
    if (ratios.empty()) return {};
    return fmt::format(
        "FLIP, of whole pictures against those of finer settings, edges of objects among them: {} of {} "
        "are within {:.2g}. Of {} that the plan predicts within, {} are. Measured over predicted: median "
        "{:.2f}. The finer pictures' own error: median {:.3g} %.\n\n",
        within, ratios.size(), flip, promised, held, median(ratios), 100 * median(finest));
}

} // namespace

std::string promisePage(std::span<const json> rows, double budget, double flip) {
    std::string out;
    const size_t measured = size_t(std::ranges::count_if(rows, isMeasured));
    if (measured < rows.size()) {
        out += fmt::format("Not measured: {} of {} scenes.\n\n", rows.size() - measured, rows.size());
        for (const json& row : rows)
            if (!isMeasured(row))
                out +=
                    fmt::format("- seed {}: {}\n", row.at("seed").get<uint64_t>(), row.value("why_not", "no reason"));
        out += '\n';
    }
    if (measured == 0) return out;
    out += table(rows, budget, "all", [](const json&) { return "all"; });
    out += table(rows, budget, "half", [](const json& row) { return text(row, "half"); });
    out += table(rows, budget, "the plan", [](const json& row) {
        return row.at("promised").get<bool>() ? "promises the budget" : "says that nothing holds it";
    });
    out += priceLine(rows) + flipLine(rows, flip);
    out += table(rows, budget, "layout", [](const json& row) { return text(row, "layout"); });
    out += table(rows, budget, "particles", Bands{"count", {4, 32, 256, 2048}}, "count");
    out += table(rows, budget, "optical depth", Bands{"depth", {0.1, 1, 10}}, "depth");
    out += table(rows, budget, "camera", [](const json& row) { return text(row, "camera"); });
    out += table(rows, budget, "method", [](const json& row) { return text(row, "method"); });
    out += table(rows, budget, "objects", [](const json& row) { return number(row, "objects") > 0 ? "some" : "none"; });
    const auto isLit = [](const json& row) { return isMeasured(row) && row.value("kind", "sun") == "lit"; };
    if (std::ranges::any_of(rows, isLit)) out += litTables(rows, budget);
    return out + "The worst, to be opened again by their seeds:\n\n" + worstTable({rows.begin(), rows.end()});
}

std::string promisePlot(std::span<const json> rows) {
    Plot plot{.title = "Measured over predicted error",
              .x_label = "predicted, %",
              .y_label = "measured, %",
              .points = {},
              .front = false};
    for (const json& row : rows)
        if (isMeasured(row))
            plot.points.push_back({.label = "",
                                   .x = 100 * number(row, "predicted"),
                                   .y = 100 * number(row, "measured"),
                                   .group = text(row, "method") == "slabs" ? 0 : 1});
    return svg(plot);
}

} // namespace brume::bench
