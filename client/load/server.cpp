#include "client/load/server.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <stdexcept>

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

} // namespace

Server::Server(const Options& options) {
    if (options.server) {
        endpoint_ = *options.server;
        try { // fails before the first run if no server is there
            (void)counters();
        } catch (const std::runtime_error& error) {
            throw std::runtime_error("no server to load at " + endpoint_.url() + ": " + error.what());
        }
        return;
    }
    process_ = start(options);
    const auto address = process_->lineStarting("listening on http://", kStart);
    if (!address) {
        const std::string why = ended();
        throw std::runtime_error("the server does not start: " + (why.empty() ? "it does not listen in time" : why));
    }
    endpoint_ = client::parseUrl("ws://" + *address); // open: what it is started for is this machine
    if (endpoint_.host == "0.0.0.0") endpoint_.host = "127.0.0.1";
    if (endpoint_.host == "::") endpoint_.host = "::1";
}

Server::~Server() {
    if (!process_) return;
    process_->signal(SIGTERM);
    process_->exitCode(kEnd);
}

Series Server::counters() const { return scrape(endpoint_, kAnswer); }

std::string Server::ended() {
    if (!process_) return {};
    const auto code = process_->exitCode(milliseconds(500)); // its sockets close a moment before the process ends
    if (!code) return {};
    const std::string words = lastLine(process_->err());
    return "it ended " +
           (*code < 0 ? "by signal " + std::to_string(-*code) : "with exit code " + std::to_string(*code)) +
           (words.empty() ? "" : ", saying: " + words);
}

ServerCost costBetween(const Series& before, const Series& after) {
    const auto grown = [&](std::string_view name) { return at(after, name) - at(before, name); };
    ServerCost cost;
    cost.cpu_s = grown("process_cpu_seconds_total");
    cost.shared_s = grown("brume_device_seconds_total{part=\"shared\"}");
    cost.views_s = grown("brume_device_seconds_total{part=\"view\"}");
    cost.batches = grown("brume_batches_total");
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

} // namespace brume::load
