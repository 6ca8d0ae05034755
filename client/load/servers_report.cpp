#include "client/load/servers_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/load/numbers.h"

namespace brume::load {
namespace {

using Json = nlohmann::json;

// 100 only where all are equal, however it is rounded.
double equalPercent(const Agreement& agreement) {
    if (agreement.compared() == 0) return NAN;
    const double percent = 100 * double(agreement.equal()) / double(agreement.compared());
    return agreement.equal() < agreement.compared() ? std::min(percent, 99.9) : percent;
}

std::string hex(uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string line(const Run& run, const ServerRun& server) {
    std::string text = fmt::format("| {} | {} | {} |", run.viewers, server.url, server.viewers);
    for (const double value :
         {double(server.frames) / run.seconds, server.pictureMs(0.5), server.pictureMs(0.95),
          double(server.pushes) / run.seconds, double(server.refused) / run.seconds, server.command_p50_ms,
          server.command_p95_ms, server.ticks_per_second, server.tick_p50_ms, server.tick_p95_ms,
          server.log_bytes_per_second * 1e-3, server.lag_ticks, server.cost.cpu_s / run.seconds})
        text += ' ' + digits(value) + " |";
    return text + '\n';
}

Json jsonOf(const Run& run, const ServerRun& server) {
    return {{"url", server.url},
            {"viewers", server.viewers},
            {"frames_per_second", rounded(double(server.frames) / run.seconds)},
            {"tick_to_picture_ms", {{"p50", rounded(server.pictureMs(0.5))}, {"p95", rounded(server.pictureMs(0.95))}}},
            {"inputs_sent", server.pushes},
            {"inputs_refused", server.refused},
            {"command_to_tick_ms", {{"p50", rounded(server.command_p50_ms)}, {"p95", rounded(server.command_p95_ms)}}},
            {"ticks_per_second", rounded(server.ticks_per_second)},
            {"tick_ms", {{"p50", rounded(server.tick_p50_ms)}, {"p95", rounded(server.tick_p95_ms)}}},
            {"log_bytes_per_second", rounded(server.log_bytes_per_second)},
            {"lag_ticks", rounded(server.lag_ticks)},
            {"cpu_s", rounded(server.cost.cpu_s)},
            {"frames_rendered", rounded(server.cost.rendered)}};
}

Json jsonOf(const Run& run, const Agreement& agreement) {
    Json difference;
    if (const auto& first = agreement.first())
        difference = {{"tick", first->tick},
                      {"servers", {run.servers[first->server].url, run.servers[first->other].url}},
                      {"hashes", {hex(first->hash), hex(first->other_hash)}}};
    return {{"ticks_compared", agreement.compared()},
            {"ticks_equal", agreement.equal()},
            {"percent", rounded(equalPercent(agreement))},
            {"first_difference", std::move(difference)}};
}

} // namespace

bool tellsServers(const Options& options) { return options.servers.size() > 1 || options.push > 0; }

std::string serversText(const std::vector<Run>& runs) {
    std::string text =
        "| viewers | server | its viewers | frames/s | tick to picture, ms: p50 | p95 | pushes/s | refused/s | "
        "command to tick, ms: p50 | p95 | ticks/s | tick, ms: p50 | p95 | log, kB/s | lag, ticks | cores |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (const Run& run : runs)
        for (const ServerRun& server : run.servers) text += line(run, server);
    std::string words;
    for (const Run& run : runs) {
        if (run.agreement)
            words +=
                fmt::format("- {} viewers: {} ticks compared, {} equal ({} %)\n", run.viewers,
                            run.agreement->compared(), run.agreement->equal(), digits(equalPercent(*run.agreement)));
        if (!run.returns.empty())
            words += fmt::format("- {} viewers: {} times one came back, after {} ms at most, {} ms at the median\n",
                                 run.viewers, run.returns.size(), digits(run.awayMs(1)), digits(run.awayMs(0.5)));
    }
    return words.empty() ? text : text + '\n' + words;
}

Json serversJson(const Run& run) {
    Json servers = Json::array();
    for (const ServerRun& server : run.servers) servers.push_back(jsonOf(run, server));
    Json json{{"servers", std::move(servers)}};
    if (run.agreement) json["agreement"] = jsonOf(run, *run.agreement);
    return json;
}

std::string differenceLine(const Run& run) {
    if (!run.agreement || !run.agreement->first()) return {};
    const auto& first = run.agreement->first();
    return fmt::format("tick {} is not the same everywhere with {} viewers: {} has state {}, {} has state {}",
                       first->tick, run.viewers, run.servers[first->server].url, hex(first->hash),
                       run.servers[first->other].url, hex(first->other_hash));
}

} // namespace brume::load
