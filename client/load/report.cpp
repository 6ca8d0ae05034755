#include "client/load/report.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/load/numbers.h"
#include "client/load/published.h"
#include "client/load/servers_report.h"
#include "common/plot.h"

namespace brume::load {
namespace {

using Json = nlohmann::json;

// As it is: errors are far below 1. NaN becomes null.
Json exact(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

void save(const std::filesystem::path& path, const std::string& text) {
    errno = 0;
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path.string() + ": " + std::strerror(errno));
}

std::string pathsOf(const Options& options) {
    std::string text;
    for (const Path& path : options.paths) {
        text += text.empty() ? "" : ",";
        text += path.stereo ? "stereo" : client::nameOf(path.kind);
    }
    return text;
}

const Run* ofOneViewer(const Report& report) {
    for (const Run& run : report.runs)
        if (run.viewers == 1) return &run;
    return nullptr;
}

// What a viewer of this run costs over one who is alone.
double cpuPerViewer(const Run& run, const Run& one) { return run.cpuMsPerFrame() / one.cpuMsPerFrame(); }
double devicePerViewer(const Run& run, const Run& one) { return run.deviceMsPerFrame() / one.deviceMsPerFrame(); }

std::string beside(const Report& report, const Run& one) {
    std::string out =
        "\n## A viewer of many, over a viewer alone\n\nCost of a frame with so many viewers over that with one. "
        "CPU: the whole server, encoding and sockets included; device:\nits passes. Beside them the media alone of "
        "Stojanovic et al. 2023 (tables 1 to 3: 1920x1080, RTX 3090), froxels of each viewer\nand their shadow "
        "grid that viewers share.\n\n| viewers | CPU | device |";
    std::string rule = "\n|---|---|---|";
    for (const Published& published : kPublished) {
        out += fmt::format(" {} |", published.name);
        rule += "---|";
    }
    out += rule + "\n";
    for (const Run& run : report.runs) {
        out += fmt::format("| {} | {} | {} |", run.viewers, digits(cpuPerViewer(run, one)),
                           digits(devicePerViewer(run, one)));
        for (const Published& published : kPublished)
            out += fmt::format(" {} |", digits(perViewer(published, run.viewers).value_or(NAN)));
        out += "\n";
    }
    return out;
}

Json jsonOf(const Run& run) {
    const ServerCost& cost = run.server;
    Json each = Json::array(), returns = Json::array(), passes = Json::object();
    for (const uint64_t frames : run.frames) each.push_back(rounded(double(frames) / run.seconds));
    for (const auto& [name, ms] : cost.passes_ms) passes[name] = rounded(ms);
    for (const Return& back : run.returns) returns.push_back({back.lost_us, back.back_us});
    const StageMeans& s = run.stages;
    return {
        {"viewers", run.viewers},
        {"seconds", rounded(run.seconds)},
        {"warm_up_s", rounded(run.warm_up_s)},
        {"frames", run.allFrames()},
        {"fps",
         {{"least", rounded(run.leastFps())}, {"median", rounded(run.medianFps())}, {"most", rounded(run.mostFps())}}},
        {"fps_each", std::move(each)},
        {"latency_ms",
         {{"p50", rounded(run.latencyMs(0.5))},
          {"p95", rounded(run.latencyMs(0.95))},
          {"p99", rounded(run.latencyMs(0.99))},
          {"samples", run.latencies_ms.size()},
          {"oldest_unanswered", rounded(run.oldest_unanswered_ms)}}},
        {"age_ms",
         {{"p50", rounded(run.ageMs(0.5))}, {"p95", rounded(run.ageMs(0.95))}, {"most", rounded(run.ageMs(1))}}},
        {"returns_us", std::move(returns)},
        {"away_ms", {{"p50", rounded(run.awayMs(0.5))}, {"most", rounded(run.awayMs(1))}}},
        {"stages_ms",
         {{"wait", rounded(s.wait)},
          {"render", rounded(s.render)},
          {"gpu", rounded(s.gpu)},
          {"encode", rounded(s.encode)},
          {"queue", rounded(s.queue)},
          {"decode", rounded(s.decode)}}},
        {"error_measured", {{"median", exact(run.errorMeasured(0.5))}, {"worst", exact(run.errorMeasured(1))}}},
        {"bytes_per_second", rounded(double(run.bytes) / run.seconds)},
        {"errors", run.errors},
        {"first_error", run.first_error},
        {"server",
         {{"cpu_s", rounded(cost.cpu_s)},
          {"cpu_ms_per_frame", rounded(run.cpuMsPerFrame())},
          {"device_shared_ms", rounded(1e3 * cost.shared_s)},
          {"device_views_ms", rounded(1e3 * cost.views_s)},
          {"batches", rounded(cost.batches)},
          {"pictures", rounded(cost.pictures)},
          {"frames_rendered", rounded(cost.rendered)},
          {"frames_superseded", rounded(cost.superseded)},
          {"memory_bytes", rounded(cost.memory_bytes)},
          {"plan_error", rounded(cost.plan_error)},
          {"plan_relaxed", rounded(cost.relaxed)},
          {"passes_ms", std::move(passes)}}},
        {"own_cpu_s", rounded(run.own_cpu_s)},
        {"machine_busy_s", rounded(run.machine_busy_s)}};
}

} // namespace

std::string tableHead() {
    return "| viewers | frames/s each: least | median | most | pose to frame, ms: p50 | p95 | p99 | age, ms: p95 | "
           "kB/s each | server, cores | ms a frame | device, ms a frame: shared | view | batches/s | pictures/s | "
           "error, %: predicted | measured, median | worst | load, cores | others, cores |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
}

std::string tableLine(const Run& run) {
    const ServerCost& cost = run.server;
    std::string line = fmt::format("| {} |", run.viewers);
    for (const double value :
         {run.leastFps(), run.medianFps(), run.mostFps(), run.latencyMs(0.5), run.latencyMs(0.95), run.latencyMs(0.99),
          run.ageMs(0.95), double(run.bytes) * 1e-3 / run.seconds / run.viewers, cost.cpu_s / run.seconds,
          run.cpuMsPerFrame(), 1e3 * cost.shared_s / cost.rendered, 1e3 * cost.views_s / cost.rendered,
          cost.batches / run.seconds, cost.pictures / run.seconds, 100 * cost.plan_error, 100 * run.errorMeasured(0.5),
          100 * run.errorMeasured(1), run.own_cpu_s / run.seconds,
          (run.machine_busy_s - run.own_cpu_s - cost.cpu_s) / run.seconds})
        line += ' ' + digits(value) + " |";
    return line + '\n';
}

std::string markdown(const Report& report, const Options& options) {
    std::string out =
        fmt::format("# Viewers of {}\n\n{}, scene `{}`, {}; {}x{}, paths {}{}; {:g} s each after {:g} s. {}.\n\n",
                    options.servers.size() > 1 ? "servers" : "one server", report.server, report.scene, report.device,
                    report.width, report.height, pathsOf(options), options.decode ? ", decoded" : "", options.seconds,
                    options.warm_up, report.machine);
    out += tableHead();
    for (const Run& run : report.runs) out += tableLine(run);
    out += "\nPose to frame: from every pose that a viewer sends, 61 a second, to the first frame of that pose or\n"
           "a later one. Age: of what a frame shows, from sending its pose; of lit particles from their tick. Shared:\n"
           "passes once a batch for all viewers of it; view: passes of each. Error: relative\n"
           "RMSE that the server's plan predicts, which grows when it gives up accuracy under load, and that the\n"
           "server measures of each viewer's pictures. Load: this program; others: what else the machine did.\n";
    if (const Run* const one = ofOneViewer(report)) out += beside(report, *one);
    if (tellsServers(options)) out += "\n## Each server\n\n" + serversText(report.runs);
    if (!report.broken.empty()) out += "\n## What does not hold\n\n";
    for (const std::string& line : report.broken) out += "- " + line + '\n';
    return out;
}

Json json(const Report& report, const Options& options) {
    Json runs = Json::array();
    for (const Run& run : report.runs) {
        runs.push_back(jsonOf(run));
        if (tellsServers(options)) runs.back().update(serversJson(run));
    }
    return {{"program", "brume-load " BRUME_VERSION},
            {"server", report.server},
            {"scene", report.scene},
            {"device", report.device},
            {"machine", report.machine},
            {"size", {report.width, report.height}},
            {"paths", pathsOf(options)},
            {"layers", options.layers},
            {"draw_hz", options.wishes.draw_hz},
            {"decode", options.decode},
            {"runs", std::move(runs)},
            {"broken", report.broken}};
}

std::string plot(const Report& report) {
    const Run* const one = ofOneViewer(report);
    Plot plot{"Cost of a viewer against the number of viewers", "viewers", "CPU, ms a frame", {}, false, true};
    const auto add = [&](const char* name, int group, double viewers, double cost, bool last) {
        plot.points.push_back({last ? name : "", viewers, cost, group});
    };
    if (one) {
        plot.y_label = "cost of a frame, over that of a viewer alone";
        int group = 2;
        for (const Published& published : kPublished) {
            if (!std::string_view(published.name).starts_with("shared")) continue;
            for (const unsigned viewers : kPublishedViewers)
                add(published.name, group, viewers, *perViewer(published, viewers),
                    viewers == kPublishedViewers.back());
            ++group;
        }
    }
    for (const Run& run : report.runs) {
        const bool last = &run == &report.runs.back();
        add("server CPU", 0, run.viewers, one ? cpuPerViewer(run, *one) : run.cpuMsPerFrame(), last);
        if (one) add("device", 1, run.viewers, devicePerViewer(run, *one), last);
    }
    return svg(plot);
}

void prepareFolder(const std::filesystem::path& folder) {
    if (folder.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw std::runtime_error("cannot make the folder " + folder.string() + ": " + error.message());
    save(folder / "load.json", {}); // now, not after an hour of measuring
}

void write(const Report& report, const Options& options) {
    if (options.out.empty()) return;
    save(options.out / "load.json", json(report, options).dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
    save(options.out / "load.md", markdown(report, options));
    save(options.out / "load.svg", plot(report));
}

} // namespace brume::load
