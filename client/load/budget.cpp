#include "client/load/budget.h"

#include <charconv>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace brume::load {
namespace {

struct Metric {
    const char* name;
    double (*of)(const Run&);
};

constexpr Metric kMetrics[] = {
    {"fps", [](const Run& r) { return r.leastFps(); }},
    {"p50", [](const Run& r) { return r.latencyMs(0.5); }},
    {"p95", [](const Run& r) { return r.latencyMs(0.95); }},
    {"p99", [](const Run& r) { return r.latencyMs(0.99); }},
    {"command_p95", [](const Run& r) { return r.commandP95Ms(); }},
    {"cpu", [](const Run& r) { return r.server.cpu_s / r.seconds; }},
};

template <class T>
std::optional<T> number(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return {};
    return value;
}

[[noreturn]] void refuse(const std::string& text) {
    throw std::invalid_argument(
        "'" + text +
        "' is not a budget: METRIC>=VALUE or METRIC<=VALUE, then @VIEWERS or nothing, such as "
        "fps>=15@16; METRIC is fps (of the slowest viewer), p50, p95, p99 (ms from pose to frame), "
        "command_p95 (ms from a command to its tick, of the slowest server) or cpu (cores of all servers)");
}

} // namespace

Budget parseBudget(const std::string& text) {
    const size_t sign = std::min(text.find(">="), text.find("<="));
    if (sign == text.npos) refuse(text);
    const size_t at = std::min(text.find('@', sign), text.size());
    Budget budget{text, nullptr, text[sign] == '>', 0, {}};
    for (const Metric& metric : kMetrics)
        if (text.compare(0, sign, metric.name) == 0) budget.of = metric.of;
    const auto bound = number<double>(std::string_view(text).substr(sign + 2, at - sign - 2));
    if (!budget.of || !bound || !std::isfinite(*bound) || *bound < 0) refuse(text);
    budget.bound = *bound;
    if (at < text.size()) {
        budget.viewers = number<uint32_t>(std::string_view(text).substr(at + 1));
        if (!budget.viewers) refuse(text);
    }
    return budget;
}

std::string broken(const Budget& budget, const Run& run) {
    if (budget.viewers && *budget.viewers != run.viewers) return {};
    const double value = budget.of(run);
    if (std::isfinite(value) && (budget.at_least ? value >= budget.bound : value <= budget.bound)) return {};
    const std::string got = std::isfinite(value) ? fmt::format("it is {:.3g}", value) : "it could not be measured";
    return fmt::format("{} does not hold with {} viewers: {}", budget.text, run.viewers, got);
}

} // namespace brume::load
