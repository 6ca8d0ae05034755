#include "server/net/viewers.h"

#include <algorithm>
#include <span>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/net/token.h"

namespace brume::net {
namespace {

using OrderedJson = nlohmann::ordered_json;

// For people: of fifteen digits eleven are noise.
double fourDigits(double value) { return std::stod(fmt::format("{:.4g}", value)); }

OrderedJson stagesOf(const History& history) {
    OrderedJson all = OrderedJson::object();
    for (size_t stage = 0; stage < History::kStages; ++stage) {
        const History::Percentiles p = history.of(stage);
        all[History::kNames[stage]] = {
            {"p50", fourDigits(p.p50)}, {"p95", fourDigits(p.p95)}, {"p99", fourDigits(p.p99)}};
    }
    return all;
}

// Measured errors of this viewer's pictures, by method.
OrderedJson errorsOf(uint32_t viewer, std::span<const ViewError> errors) {
    OrderedJson all = OrderedJson::object();
    for (const ViewError& one : errors) {
        const ErrorEstimate& e = one.error;
        if (one.viewer != viewer || !e.known()) continue;
        all[one.method] = {{"relative_rmse", fourDigits(e.rmse)}, {"low", fourDigits(e.low)},
                           {"high", fourDigits(e.high)},          {"predicted", fourDigits(e.law)},
                           {"bias", fourDigits(e.bias)},          {"pixels", e.pixels}};
    }
    return all;
}

OrderedJson of(const Viewer& viewer, const Person* person, std::span<const ViewError> errors, Clock::time_point now) {
    const Viewer::Link link = viewer.link();
    const Viewer::Counts counts = viewer.counts();
    const History history = viewer.history();
    OrderedJson one{{"id", viewer.id()}};
    if (person) {
        one["name"] = person->name;
        one["name_by_token"] = person->known;
        one["colour"] = fmt::format("#{:06x}", person->colour);
        one["role"] = nameOf(Role(person->role));
        one["follows"] = person->follows;
    }
    if (const auto pose = viewer.pose()) {
        one["size"] = {pose->width, pose->height};
        one["eyes"] = pose->views;
        one["hidden"] = pose->hidden;
    }
    one["window_frames"] = link.frames;
    one["frames_in_flight"] = counts.in_flight;
    one["bytes_in_flight"] = link.bytes_in_flight;
    one["round_trip_ms"] = fourDigits(link.round_trip_ms);
    one["queue_ms"] = fourDigits(link.queue_ms);
    one["quality"] = {{"jpeg", link.step.quality},
                      {"half", link.step.half},
                      {"every", link.step.every},
                      {"link_step", link.level},
                      {"device_step", link.device_level}};
    one["frames_per_second"] = fourDigits(history.rate(now));
    one["frames"] = {{"rendered", counts.rendered}, {"sent", counts.sent}, {"superseded", counts.superseded}};
    one["stages_ms"] = stagesOf(history);
    one["error"] = errorsOf(viewer.id(), errors);
    return one;
}

} // namespace

std::string viewersJson(const Audience& audience) {
    std::vector<std::shared_ptr<Viewer>> viewers;
    audience.list(viewers);
    OrderedJson list = OrderedJson::array();
    const auto now = Clock::now();
    const auto report = audience.report();
    const People::Now people = audience.people().now();
    for (const auto& viewer : viewers) {
        const auto person = std::ranges::find(people.people, viewer->id(), &Person::id);
        list.push_back(of(*viewer, person == people.people.end() ? nullptr : &*person, report->errors, now));
    }
    return OrderedJson{{"presenter", people.presenter}, {"viewers", std::move(list)}}.dump() + "\n";
}

} // namespace brume::net
