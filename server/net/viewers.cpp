#include "server/net/viewers.h"

#include <algorithm>
#include <span>

#include <nlohmann/json.hpp>

namespace brume::net {
namespace {

using Json = nlohmann::ordered_json;

Json stagesOf(const History& history) {
    Json all = Json::object();
    for (size_t stage = 0; stage < History::kStages; ++stage) {
        const History::Percentiles p = history.of(stage);
        all[History::kNames[stage]] = {{"p50", p.p50}, {"p95", p.p95}, {"p99", p.p99}};
    }
    return all;
}

// Measured errors of this viewer's pictures, by method.
Json errorsOf(uint32_t viewer, std::span<const ViewError> errors) {
    Json all = Json::object();
    for (const ViewError& one : errors) {
        const ErrorEstimate& e = one.error;
        if (one.viewer != viewer || !e.known()) continue;
        all[one.method] = {{"relative_rmse", e.rmse}, {"low", e.low},   {"high", e.high},
                           {"predicted", e.law},      {"bias", e.bias}, {"pixels", e.pixels}};
    }
    return all;
}

Json of(const Viewer& viewer, std::span<const ViewError> errors, Clock::time_point now) {
    const Viewer::Link link = viewer.link();
    const Viewer::Counts counts = viewer.counts();
    const History history = viewer.history();
    Json one{{"id", viewer.id()}};
    if (const auto pose = viewer.pose()) {
        one["size"] = {pose->width, pose->height};
        one["eyes"] = pose->views;
        one["hidden"] = pose->hidden;
    }
    one["window_frames"] = link.frames;
    one["frames_in_flight"] = counts.in_flight;
    one["bytes_in_flight"] = link.bytes_in_flight;
    one["round_trip_ms"] = link.round_trip_ms;
    one["queue_ms"] = link.queue_ms;
    one["quality"] = {{"jpeg", link.step.quality},
                      {"half", link.step.half},
                      {"every", link.step.every},
                      {"link_step", link.level},
                      {"device_step", link.device_level}};
    one["frames_per_second"] = history.rate(now);
    one["frames"] = {{"rendered", counts.rendered}, {"sent", counts.sent}, {"superseded", counts.superseded}};
    one["stages_ms"] = stagesOf(history);
    one["error"] = errorsOf(viewer.id(), errors);
    return one;
}

} // namespace

std::string viewersJson(const Audience& audience) {
    std::vector<std::shared_ptr<Viewer>> viewers;
    audience.list(viewers);
    Json list = Json::array();
    const auto now = Clock::now();
    const auto report = audience.report();
    for (const auto& viewer : viewers) list.push_back(of(*viewer, report->errors, now));
    return Json{{"viewers", std::move(list)}}.dump() + "\n";
}

} // namespace brume::net
