#include "client/native/statistics.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace brume::client {
namespace {

using Json = nlohmann::json;

struct Stage {
    const char* name;
    std::optional<float> (*of)(const FrameRecord&);
};

// In the order in which a frame passes them; `gpu` is a part of `render`, `total` is from the pose to the presented
// frame.
constexpr Stage kStages[] = {
    {"total", [](const FrameRecord& r) { return r.total_ms; }},
    {"network", [](const FrameRecord& r) { return r.networkMs(); }},
    {"wait", [](const FrameRecord& r) { return std::optional(r.wait_ms); }},
    {"render", [](const FrameRecord& r) { return std::optional(r.render_ms); }},
    {"gpu", [](const FrameRecord& r) { return std::optional(r.gpu_ms); }},
    {"encode", [](const FrameRecord& r) { return std::optional(r.encode_ms); }},
    {"queue", [](const FrameRecord& r) { return std::optional(r.queue_ms); }},
    {"decode", [](const FrameRecord& r) { return std::optional(r.decode_ms); }},
};

// Milliseconds to the microsecond.
Json orNull(std::optional<float> value) {
    return value ? Json(std::round(double(*value) * 1e3) * 1e-3) : Json(nullptr);
}

// 64 bits do not fit a JSON number that JavaScript reads.
std::string hex(uint64_t value) { return fmt::format("{:#018x}", value); }

Json jsonOf(const FrameRecord& r) {
    const glm::vec3 p = r.position;
    const glm::quat q = r.orientation;
    return {{"id", r.id},
            {"tick", r.tick},
            {"state_hash", hex(r.state_hash)},
            {"pose",
             {{"seq", r.pose_seq},
              {"position", {p.x, p.y, p.z}},
              {"orientation_xyzw", {q.x, q.y, q.z, q.w}},
              {"fov_y", r.fov_y}}},
            {"size", {r.width, r.height}},
            {"views", r.views},
            {"quality", r.quality},
            {"bytes", r.bytes},
            {"total_ms", orNull(r.total_ms)}};
}

} // namespace

std::optional<float> FrameRecord::networkMs() const {
    if (!total_ms) return {};
    return *total_ms - wait_ms - render_ms - encode_ms - queue_ms - decode_ms;
}

FrameRecord recordOf(const Received& message, float decode_ms, uint64_t presented_us) {
    const auto& frame = *message.as<wire::Frame>();
    const auto& stages = *frame.stages();
    const auto& p = *frame.position();
    const auto& q = *frame.orientation();
    FrameRecord record;
    record.id = frame.id();
    record.pose_seq = frame.pose_seq();
    record.tick = frame.tick();
    record.state_hash = frame.state_hash();
    record.presented_us = presented_us;
    if (frame.client_time_us() > 0 && frame.client_time_us() <= presented_us)
        record.total_ms = static_cast<float>(presented_us - frame.client_time_us()) * 1e-3f;
    record.wait_ms = stages.wait();
    record.render_ms = stages.render();
    record.encode_ms = stages.encode();
    record.queue_ms = stages.queue();
    record.gpu_ms = stages.gpu();
    record.decode_ms = decode_ms;
    record.bytes = static_cast<uint32_t>(message.size());
    record.width = frame.width();
    record.height = frame.height();
    record.quality = frame.quality();
    record.views = static_cast<uint8_t>(frame.jpeg_bytes()->size());
    record.position = {p.x(), p.y(), p.z()};
    record.orientation = glm::quat(q.w(), q.x(), q.y(), q.z());
    record.fov_y = frame.fov_y();
    record.error = frame.measured();
    record.error_low = frame.measured_low();
    record.error_high = frame.measured_high();
    return record;
}

FrameRecord recordOf(const Received& message, float draw_ms, uint64_t presented_us, const Pose& pose,
                     const Picture& picture) {
    const auto& lit = *message.as<wire::LitParticles>();
    FrameRecord record;
    record.id = lit.id();
    record.tick = lit.tick();
    record.state_hash = lit.state_hash();
    record.presented_us = presented_us;
    record.decode_ms = draw_ms;
    record.bytes = uint32_t(message.size());
    record.width = uint16_t(picture.width), record.height = uint16_t(picture.height);
    record.position = pose.position, record.orientation = pose.orientation, record.fov_y = pose.fov_y;
    record.error = lit.measured(), record.error_low = lit.measured_low(), record.error_high = lit.measured_high();
    return record;
}

std::optional<float> percentile(std::vector<float> values, double fraction) {
    if (values.empty()) return {};
    const double rank = std::ceil(fraction * static_cast<double>(values.size()));
    const size_t index = std::min(values.size() - 1, static_cast<size_t>(std::max(rank, 1.0)) - 1);
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
    return values[index];
}

void Statistics::welcome(const Granted& granted) {
    granted_ = granted;
    // A second welcome on one connection tells of another scene.
    if (!key_.empty() && granted.resume == key_) return;
    key_ = granted.resume;
    ++welcomes_;
    if (granted.resumed) ++resumed_;
}

void Statistics::frame(const FrameRecord& record) {
    if (frames_++ == 0) first_us_ = record.presented_us;
    bytes_ += record.bytes;
    if (records_.size() == kMaxRecords) records_.pop_front();
    records_.push_back(record);
}

void Statistics::error(const wire::Error& error) {
    ++errors_;
    if (error_records_.size() == kMaxErrors) return; // the first ones tell the cause
    error_records_.push_back({error.code(), error.input_seq(), error.text() ? error.text()->str() : ""});
}

double Statistics::secondsShown() const {
    return records_.empty() ? 0 : static_cast<double>(records_.back().presented_us - first_us_) * 1e-6;
}

double Statistics::frameRate() const {
    return secondsShown() > 0 ? static_cast<double>(frames_ - 1) / secondsShown() : 0;
}

double Statistics::recentRate(uint64_t since_us) const {
    size_t count = 0;
    uint64_t oldest = 0;
    for (auto r = records_.rbegin(); r != records_.rend() && r->presented_us >= since_us; ++r, ++count)
        oldest = r->presented_us;
    if (count < 2) return 0;
    return static_cast<double>(count - 1) * 1e6 / static_cast<double>(records_.back().presented_us - oldest);
}

std::optional<float> Statistics::recentLatencyMs(uint64_t since_us) const {
    std::vector<float> values;
    for (auto r = records_.rbegin(); r != records_.rend() && r->presented_us >= since_us; ++r)
        if (r->total_ms) values.push_back(*r->total_ms);
    return percentile(std::move(values), 0.5);
}

const FrameRecord* Statistics::lastMeasured() const {
    const auto last = std::find_if(records_.rbegin(), records_.rend(), [](const auto& r) { return r.error > 0; });
    return last == records_.rend() ? nullptr : &*last;
}

std::vector<float> Statistics::stage(std::optional<float> (*of)(const FrameRecord&)) const {
    std::vector<float> values;
    values.reserve(records_.size());
    for (const auto& record : records_)
        if (const auto value = of(record)) values.push_back(*value);
    return values;
}

Json Statistics::json() const {
    Json latency = Json::object();
    for (const Stage& s : kStages) {
        const std::vector<float> values = stage(s.of);
        latency[s.name] = {{"p50", orNull(percentile(values, 0.5))},
                           {"p95", orNull(percentile(values, 0.95))},
                           {"p99", orNull(percentile(values, 0.99))}};
    }
    Json errors = Json::array();
    for (const auto& e : error_records_)
        errors.push_back({{"code", wire::EnumNameErrorCode(e.code)}, {"text", e.text}, {"input_seq", e.input_seq}});
    Json pictures = Json::array();
    for (const auto& record : records_) pictures.push_back(jsonOf(record));

    Json measured;
    if (const FrameRecord* r = lastMeasured())
        measured = {{"relative_rmse", r->error}, {"low", r->error_low}, {"high", r->error_high}};

    return {{"client", "brume-client " BRUME_VERSION},
            {"url", url_},
            {"server", granted_.server},
            {"scene", granted_.scene},
            {"device", granted_.device},
            {"viewer", granted_.viewer},
            {"connections", welcomes_},
            {"resumed", resumed_},
            {"ended", ended_},
            {"frames", frames_},
            {"dropped", dropped_},
            {"redrawn", redrawn_},
            {"seconds", secondsShown()},
            {"frame_rate", frameRate()},
            {"bytes", bytes_},
            {"inputs_sent", inputs_},
            {"round_trip_ms", orNull(round_trip_ms_)},
            {"latency_ms", std::move(latency)},
            {"picture_error", std::move(measured)},
            {"error_count", errors_},
            {"errors", std::move(errors)},
            {"pictures", std::move(pictures)}};
}

std::string Statistics::summary() const {
    std::string text =
        fmt::format("{} frames in {:.2f} s ({:.1f} a second), {:.1f} kB a frame, ticks {} to {}", frames_,
                    secondsShown(), frameRate(), static_cast<double>(bytes_) / static_cast<double>(frames_) * 1e-3,
                    records_.front().tick, records_.back().tick);
    if (dropped_ > 0) text += fmt::format(", {} dropped for newer ones", dropped_);
    text += "\nlatency, median / 95 % (ms):";
    for (const Stage& s : kStages) {
        const std::vector<float> values = stage(s.of);
        if (const auto p50 = percentile(values, 0.5))
            text += fmt::format(" {} {:.1f}/{:.1f}", s.name, *p50, *percentile(values, 0.95));
    }
    if (const FrameRecord* r = lastMeasured())
        text += fmt::format("\nerror of the pictures, measured: {:.2g} % ({:.2g} to {:.2g})", 100 * r->error,
                            100 * r->error_low, 100 * r->error_high);
    if (errors_ > 0)
        text += fmt::format("\n{} errors from the server, the first: {} ({})", errors_,
                            wire::EnumNameErrorCode(error_records_.front().code), error_records_.front().text);
    return text;
}

} // namespace brume::client
