#include "tools/bench/report.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/plot.h"
#include "tools/bench/parts.h"

namespace brume::bench {
namespace {

using nlohmann::json;

double numberAt(const json& row, const char* path) {
    const json::json_pointer at(path);
    return row.contains(at) && row.at(at).is_number() ? row.at(at).get<double>() : std::nan("");
}

// Three digits that count; "-" for what there is not.
std::string digits(double value, double times = 1, const char* unit = "") {
    if (!std::isfinite(value)) return "-";
    char text[64];
    const double v = value * times;
    std::snprintf(text, sizeof text, std::abs(v) >= 100 ? "%.0f" : std::abs(v) >= 10 ? "%.1f" : "%.3g", v);
    return text + std::string(unit);
}

std::string whole(double value) { return std::isfinite(value) ? std::to_string(std::llround(value)) : "-"; }

std::string place(const json& row) {
    std::string text =
        "`" + row.value("scene", "") + "`, " + row.value("camera", "outside") + ", " + row.value("size", "");
    if (row.value("viewers", 1) > 1) text += ", " + std::to_string(row.value("viewers", 1)) + " viewers";
    return text;
}

std::string plain(std::string markdown) {
    std::erase(markdown, '`');
    return markdown;
}

class Table {
public:
    explicit Table(const std::vector<std::string>& heads) {
        line(heads), line(std::vector<std::string>(heads.size(), "---"));
    }
    void line(const std::vector<std::string>& cells) {
        text_ += '|';
        for (const std::string& cell : cells) text_ += ' ' + cell + " |";
        text_ += '\n';
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
};

// Rows of one place (scene, camera, size, viewers), in their order.
std::vector<std::pair<std::string, std::vector<json>>> byPlace(const json& series) {
    std::vector<std::pair<std::string, std::vector<json>>> places;
    for (const json& row : series.at("rows")) {
        if (places.empty() || places.back().first != place(row)) places.push_back({place(row), {}});
        places.back().second.push_back(row);
    }
    return places;
}

std::string fileName(const std::string& text) {
    std::string out;
    for (const char c : text)
        if (std::isalnum(static_cast<unsigned char>(c)))
            out += char(std::tolower(static_cast<unsigned char>(c)));
        else if (!out.empty() && out.back() != '-')
            out += '-';
    while (!out.empty() && out.back() == '-') out.pop_back();
    return out;
}

std::string costTables(const json& series, const std::filesystem::path& folder, const std::string& name) {
    const bool errors = !series.value("error", "").empty(), published = !series.value("published_on", "").empty();
    std::string out;
    for (const auto& [where, rows] : byPlace(series)) {
        double published_base = std::nan("");
        json base;
        for (const json& row : rows)
            if (row.at("variant") == series.at("baseline")) base = row, published_base = numberAt(row, "/published_ms");
        // A median, with the least in brackets; and how many times the baseline's that is.
        const auto timesOf = [&](const json& row, const std::string& what) {
            const auto both = [&](const auto& text) {
                const std::string least = text("/" + what + "_least_ms");
                return text("/" + what + "_ms") + (least == "-" ? "" : " (" + least + ")");
            };
            return std::pair(both([&](const std::string& at) { return digits(numberAt(row, at.c_str())); }),
                             both([&](const std::string& at) {
                                 return digits(numberAt(base, at.c_str()) / numberAt(row, at.c_str()));
                             }));
        };
        std::vector<std::string> heads = {"variant",    "medium, ms",     "times faster", "picture, ms", "times faster",
                                          "shared, ms", "wall, ms (p95)", "fragments",    "device, MiB"};
        if (errors) heads.insert(heads.end(), {"relative RMSE", "at edges", "bias", "FLIP", "worst pixel"});
        const bool beside = !rows.empty() && rows.front().contains("beside");
        if (beside) heads.insert(heads.end(), {"beside", "FLIP beside"});
        const bool ground = rows.front().contains("ground");
        if (ground) heads.insert(heads.end(), {"ground's shadow, RMS", "bias"});
        if (published) heads.insert(heads.end(), {"published, ms", "published, times faster"});
        Table table(heads);
        std::map<std::string, int> groups; // "isv, Simpson 2" has isv's colour
        Plot plot{
            series.at("name").get<std::string>() + ": " + plain(where), "medium passes, ms", "relative RMSE, %", {}};
        for (const json& row : rows) {
            const double ms = numberAt(row, "/medium_ms");
            const auto [medium, medium_times] = timesOf(row, "medium");
            const auto [picture, picture_times] = timesOf(row, "views");
            std::vector<std::string> cells = {row.at("variant"),
                                              medium,
                                              medium_times,
                                              picture,
                                              picture_times,
                                              digits(numberAt(row, "/shared_ms")),
                                              digits(numberAt(row, "/wall_ms")) + " (" +
                                                  digits(numberAt(row, "/wall_p95_ms")) + ")",
                                              digits(numberAt(row, "/fragments"), 1e-6, " M"),
                                              digits(numberAt(row, "/device_mib"))};
            if (errors) {
                const double rmse = numberAt(row, "/error/relative_rmse");
                cells.insert(cells.end(),
                             {digits(rmse, 100, " %"), digits(numberAt(row, "/error/edges/relative_rmse"), 100, " %"),
                              digits(numberAt(row, "/error/bias"), 100, " %"), digits(numberAt(row, "/error/flip")),
                              digits(numberAt(row, "/error/worst/error"), 100, " %") + " at " +
                                  whole(numberAt(row, "/error/worst/x")) + ", " +
                                  whole(numberAt(row, "/error/worst/y"))});
                const std::string variant = row.at("variant");
                const auto [group, unused] =
                    groups.try_emplace(variant.substr(0, variant.find(',')), int(groups.size()));
                plot.points.push_back({variant, ms, 100 * rmse, group->second});
            }
            if (beside)
                cells.insert(cells.end(), {digits(numberAt(row, "/beside/relative_rmse"), 100, " %"),
                                           digits(numberAt(row, "/beside/flip"))});
            if (ground)
                cells.insert(cells.end(),
                             {digits(numberAt(row, "/ground/rms")), digits(numberAt(row, "/ground/bias"))});
            const double theirs = numberAt(row, "/published_ms");
            if (published) cells.insert(cells.end(), {digits(theirs), digits(published_base / theirs)});
            table.line(cells);
        }
        out += "### " + where + "\n\n" + table.text() + "\n";
        if (plot.points.size() > 1) {
            const std::string file = name + '-' + fileName(plot.title) + ".svg";
            std::ofstream(folder / file) << svg(plot);
            out += "![time against error](" + file + ")\n\n";
        }
    }
    return out;
}

std::string jpegTable(const json& series) {
    Table table({"picture", "variant", "quality", "bytes", "encode, ms", "PSNR, dB", "FLIP"});
    for (const json& row : series.at("rows"))
        table.line({place(row), row.at("variant"), whole(numberAt(row, "/quality")), whole(numberAt(row, "/bytes")),
                    digits(numberAt(row, "/encode_ms")), digits(numberAt(row, "/psnr")),
                    digits(numberAt(row, "/flip"))});
    return table.text() + "\n";
}

std::string phaseTable(const json& series) {
    Table table({"picture", "variant", "relative RMSE", "FLIP", "ratio of the two"});
    for (const json& row : series.at("rows"))
        table.line({place(row), row.at("variant"), digits(numberAt(row, "/beside/relative_rmse"), 100, " %"),
                    digits(numberAt(row, "/beside/flip")),
                    digits(numberAt(row, "/least_ratio")) + " to " + digits(numberAt(row, "/most_ratio"))});
    return table.text() + "\n";
}

std::string lightTable(const json& series) {
    Table table({"picture", "variant", "texels, planes", "time, ms", "relative RMSE", "estimated", "bias", "FLIP"});
    for (const json& row : series.at("rows"))
        table.line({"`" + row.value("scene", "") + "`, " + row.value("camera", ""), row.at("variant"),
                    whole(numberAt(row, "/columns")) + " x " + whole(numberAt(row, "/rows")) + " x " +
                        whole(numberAt(row, "/planes")),
                    digits(numberAt(row, "/shadow_ms")), digits(numberAt(row, "/relative_rmse"), 100, " %"),
                    digits(numberAt(row, "/estimated"), 100, " %"), digits(numberAt(row, "/bias"), 100, " %"),
                    digits(numberAt(row, "/flip"))});
    return table.text() + "\n";
}

std::string seamTable(const json& series) {
    Table table({"picture", "variant", "pixels", "kinks above 1 %", "99th percentile", "median"});
    for (const json& row : series.at("rows"))
        table.line({place(row), row.at("variant"), whole(numberAt(row, "/pixels")),
                    digits(numberAt(row, "/seams"), 100, " %"), digits(numberAt(row, "/kink_p99"), 100, " %"),
                    digits(numberAt(row, "/kink_median"), 100, " %")});
    return table.text() + "\n";
}

std::string withDeviation(const json& of, const char* mean, const char* deviation, double times, const char* unit) {
    return digits(numberAt(of, mean), times) + " ± " + digits(numberAt(of, deviation), times) + unit;
}

std::string motionTable(const json& series) {
    Table errors({"picture", "what moves", "variant", "relative RMSE", "largest", "flicker", "temporal FLIP beyond",
                  "lag, frames", "ghost", "brightness from frame to frame"}),
        times({"picture", "what moves", "variant", "place", "frames", "mean, ms", "deviation, ms", "variance, ms²"});
    bool any = false; // errors
    for (const json& row : series.at("rows")) {
        any = any || row.contains("flicker");
        errors.line(
            {place(row), row.at("mover"), row.at("variant"),
             withDeviation(row, "/relative_rmse", "/rmse_deviation", 100, " %"),
             digits(numberAt(row, "/rmse_greatest"), 100, " %") + " in " + whole(numberAt(row, "/greatest_frame")),
             digits(numberAt(row, "/flicker"), 100, " %"), digits(numberAt(row, "/temporal_flip")),
             digits(numberAt(row, "/lag")), digits(numberAt(row, "/ghost"), 100, " %"),
             fmt::format("{:.4f} … {:.4f}", numberAt(row, "/ratio_least"), numberAt(row, "/ratio_greatest"))});
        const auto time = [&](const std::string& where, const json& ms) {
            times.line({place(row), row.at("mover"), row.at("variant"), where, whole(numberAt(ms, "/frames")),
                        digits(numberAt(ms, "/mean")), digits(numberAt(ms, "/deviation")),
                        digits(numberAt(ms, "/variance"))});
        };
        time("all", row.at("ms"));
        for (size_t i = 0; row.contains("places") && i < row["places"].size(); ++i)
            time(std::to_string(i + 1), row["places"][i]);
    }
    return (any ? errors.text() + "\n" : "") + times.text() + "\n";
}

std::string list(const json& texts) {
    std::string out;
    for (const json& text : texts) out += (out.empty() ? "`" : ", `") + text.get<std::string>() + '`';
    return out;
}

// False: the results are older than the definition that counts edges apart.
bool edgesApart(const json& results) {
    for (const json& series : results.at("series"))
        for (const json& row : series.at("rows"))
            if (row.contains("error") && !row.at("error").contains("edges")) return false;
    return true;
}

} // namespace

void writeReport(const json& results, const std::filesystem::path& folder, const std::string& name) {
    if (!results.contains("series") || !results.contains("device"))
        throw std::runtime_error("not the results of a sweep");
    std::filesystem::create_directories(folder);
    std::string out =
        "# Speed against error\n\nDevice: " + results.at("device").get<std::string>() + ", driver " +
        results.value("driver", "") + "; CPU: " + results.value("cpu", "") + "; commit " +
        results.value("commit", "unknown") + ", " + results.value("date", "") + ". Made by `" +
        results.value("command", "") + "` in " + digits(numberAt(results, "/seconds") / 60) +
        " minutes; most memory of the process: " + digits(numberAt(results, "/peak_mib")) +
        " MiB.\n\nMedium: cull, sort and draw of all viewers; picture: all that is done for them, "
        "from the background to the planes that JPEG takes. Medians of all frames; in brackets the "
        "least, which a busy machine spoils less. Shared: what is done once per tick for all of them "
        "(upload, shadow maps). Errors, edges and bias: as docs/conventions.md defines them, of "
        "the medium without sky and ambient light. Times faster: against the row of that name that says 1." +
        (edgesApart(results) ? ""
                             : " These results are of a time when edges were not counted apart: the errors hold "
                               "them too, in scenes with objects.") +
        "\n\n";
    for (const json& series : results.at("series")) {
        out += "## " + series.at("name").get<std::string>() + "\n\n" + series.value("about", "");
        if (!series.at("set").empty()) out += " Settings: " + list(series.at("set")) + '.';
        if (!series.value("error", "").empty()) {
            out += " Errors at " + series.value("error", "");
            if (const int every = series.value("every", 1); every > 1)
                out += ", every " + std::to_string(every) + "th pixel";
            if (const std::string beside = series.value("beside", ""); !beside.empty())
                out += ", beside the variant " + beside;
            out += '.';
        }
        if (!series.value("published_on", "").empty())
            out += " Published figures: " + series.value("published_on", "") + '.';
        out += "\n\n";
        const std::string kind = series.at("kind");
        out += kind == "jpeg"     ? jpegTable(series)
               : kind == "light"  ? lightTable(series)
               : kind == "phase"  ? phaseTable(series)
               : kind == "seams"  ? seamTable(series)
               : kind == "motion" ? motionTable(series)
               : kind == "parts"  ? partsTables(series)
                                  : costTables(series, folder, name);
    }
    std::ofstream file(folder / (name + ".md"));
    file << out;
    if (!file.flush()) throw std::runtime_error((folder / (name + ".md")).string() + ": cannot be written");
}

std::string compareResults(const json& before, const json& now) {
    std::map<std::string, json> old;
    const auto keyOf = [](const json& series, const json& row) {
        return series.at("name").get<std::string>() + " · " + place(row) + " · " + row.at("variant").get<std::string>();
    };
    for (const json& series : before.at("series"))
        for (const json& row : series.at("rows")) old[keyOf(series, row)] = row;
    Table table(
        {"what", "medium, ms before", "now", "now / before", "relative RMSE before", "now", "at edges before", "now"});
    for (const json& series : now.at("series"))
        for (const json& row : series.at("rows")) {
            const auto found = old.find(keyOf(series, row));
            if (found == old.end()) continue;
            const double a = numberAt(found->second, "/medium_ms"), b = numberAt(row, "/medium_ms");
            const auto error = [](const json& of, const char* at) { return digits(numberAt(of, at), 100, " %"); };
            constexpr const char *kMedium = "/error/relative_rmse", *kEdges = "/error/edges/relative_rmse";
            table.line({found->first, digits(a), digits(b), digits(b / a), error(found->second, kMedium),
                        error(row, kMedium), error(found->second, kEdges), error(row, kEdges)});
        }
    return table.text();
}

} // namespace brume::bench
