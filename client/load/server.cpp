#include "client/load/server.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <stdexcept>

#include "client/load/histogram.h"

namespace brume::load {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kStart{120'000}; // a CPU driver compiles its shaders first
constexpr milliseconds kAnswer{10'000}, kEnd{5'000};

std::string lastLine(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text.substr(text.rfind('\n') + 1); // npos + 1 is 0
}

std::unique_ptr<Process> start(const Options& options) {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "brume-server";
    if (!std::filesystem::exists(program)) throw std::runtime_error("there is no server to start: " + program.string());
    const std::string room =
        std::to_string(std::max(32u, *std::max_element(options.viewers.begin(), options.viewers.end())));
    const std::string sockets = std::to_string(2 * kMostViewers);
    std::vector<std::string> command{program.string(),
                                     "--port",
                                     "0",
                                     "--log-level",
                                     "warn",
                                     "--max-viewers",
                                     room,
                                     "--max-viewers-per-address",
                                     room,
                                     "--accept-rate",
                                     sockets,
                                     "--max-connections",
                                     sockets,
                                     "--max-connections-per-address",
                                     sockets};
    command.insert(command.end(), options.server_arguments.begin(),
                   options.server_arguments.end()); // the last one wins
    return std::make_unique<Process>(command);
}

double at(const Series& series, std::string_view name) {
    const auto found = series.find(name);
    return found == series.end() ? NAN : found->second;
}

// A counter that went down began anew: how much it counted is not known.
double grownBy(double before, double after) { return after >= before ? after - before : NAN; }

// A counter without labels, or the sum of those of this name with any labels.
double sum(const Series& series, const std::string& name) {
    double all = at(series, name);
    const std::string labelled = name + '{';
    for (auto it = series.lower_bound(labelled); it != series.end() && it->first.starts_with(labelled); ++it)
        all = std::isnan(all) ? it->second : all + it->second;
    return all;
}

} // namespace

Servers::Servers(const Options& options) : endpoints_(options.servers) {
    for (const client::Endpoint& endpoint : endpoints_) {
        try { // fails before the first run if no server is there
            (void)scrape(endpoint, kAnswer);
        } catch (const std::runtime_error& error) {
            throw std::runtime_error("no server to load at " + endpoint.url() + ": " + error.what());
        }
    }
    if (!endpoints_.empty()) return;
    process_ = start(options);
    const auto address = process_->lineStarting("listening on http://", kStart);
    if (!address) {
        const std::string why = ended();
        throw std::runtime_error("the server does not start: " + (why.empty() ? "it does not listen in time" : why));
    }
    client::Endpoint& endpoint = endpoints_.emplace_back(client::parseUrl("ws://" + *address));
    if (endpoint.host == "0.0.0.0") endpoint.host = "127.0.0.1"; // open: what it is started for is this machine
    if (endpoint.host == "::") endpoint.host = "::1";
}

Servers::~Servers() {
    if (!process_) return;
    process_->signal(SIGTERM);
    process_->exitCode(kEnd);
}

std::vector<Series> Servers::counters(bool some_may_be_away) const {
    std::vector<Series> all;
    for (const client::Endpoint& endpoint : endpoints_) {
        try {
            all.push_back(scrape(endpoint, kAnswer));
        } catch (const std::runtime_error&) {
            if (!some_may_be_away) throw;
            all.emplace_back();
        }
    }
    return all;
}

std::string Servers::ended() {
    if (!process_) return {};
    const auto code = process_->exitCode(milliseconds(500)); // its sockets close a moment before the process ends
    if (!code) return {};
    const std::string words = lastLine(process_->err());
    return "it ended " +
           (*code < 0 ? "by signal " + std::to_string(-*code) : "with exit code " + std::to_string(*code)) +
           (words.empty() ? "" : ", saying: " + words);
}

ServerCost costBetween(const Series& before, const Series& after) {
    const auto grown = [&](std::string_view name) { return grownBy(at(before, name), at(after, name)); };
    ServerCost cost;
    cost.cpu_s = grown("process_cpu_seconds_total");
    cost.shared_s = grown("brume_device_seconds_total{part=\"shared\"}");
    cost.views_s = grown("brume_device_seconds_total{part=\"view\"}");
    cost.batches = grown("brume_batches_total");
    cost.pictures = grown("brume_pictures_total");
    cost.rendered = grown("brume_frames_total{fate=\"rendered\"}");
    cost.superseded = grown("brume_frames_total{fate=\"superseded\"}");
    cost.memory_bytes = at(after, "process_resident_memory_bytes");
    cost.plan_error = at(after, "brume_plan_error");
    cost.relaxed = at(after, "brume_plan_relaxed");
    constexpr std::string_view pass = "brume_pass_seconds{pass=\"";
    for (const auto& [name, seconds] : after)
        if (name.starts_with(pass))
            cost.passes_ms[name.substr(pass.size(), name.size() - pass.size() - 2)] = seconds * 1e3;
    return cost;
}

ServerCost total(const std::vector<ServerRun>& servers) {
    ServerCost all = servers.front().cost;
    for (size_t i = 1; i < servers.size(); ++i) {
        const ServerCost& cost = servers[i].cost;
        for (double ServerCost::*part :
             {&ServerCost::cpu_s, &ServerCost::shared_s, &ServerCost::views_s, &ServerCost::batches,
              &ServerCost::pictures, &ServerCost::rendered, &ServerCost::superseded, &ServerCost::memory_bytes})
            all.*part += cost.*part;
        for (double ServerCost::*part : {&ServerCost::plan_error, &ServerCost::relaxed})
            all.*part = std::fmax(all.*part, cost.*part);
        for (const auto& [name, ms] : cost.passes_ms) {
            double& most = all.passes_ms[name];
            most = std::max(most, ms);
        }
    }
    return all;
}

void readCounters(ServerRun& server, const Series& before, const Series& after, double seconds) {
    const auto ms = [&](std::string_view histogram, double fraction) {
        return 1e3 * percentileBetween(before, after, histogram, fraction);
    };
    const auto rate = [&](const std::string& name) { return grownBy(sum(before, name), sum(after, name)) / seconds; };
    server.cost = costBetween(before, after);
    server.command_p50_ms = ms("brume_command_to_tick_seconds", 0.5);
    server.command_p95_ms = ms("brume_command_to_tick_seconds", 0.95);
    server.tick_p50_ms = ms("brume_tick_seconds", 0.5);
    server.tick_p95_ms = ms("brume_tick_seconds", 0.95);
    server.ticks_per_second = rate("brume_tick_seconds_count");
    server.log_bytes_per_second = rate("brume_cluster_log_bytes_total");
    server.lag_ticks = at(after, "brume_cluster_lag_ticks");
}

} // namespace brume::load
