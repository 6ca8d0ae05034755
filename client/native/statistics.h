// What a viewer measures: frame rates, latency by stage, and which ticks and state hashes its frames had.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "client/native/jpeg.h"
#include "client/native/session.h"

namespace brume::client {

// One frame that was presented. *_ms are durations, measured here or, for wire::Stages, by the server.
struct FrameRecord {
    uint32_t id = 0, pose_seq = 0;
    uint64_t tick = 0, state_hash = 0;
    uint64_t presented_us = 0;
    std::optional<float> total_ms; // from sending the pose to presenting the frame; none: the echoed time is impossible
    float wait_ms = 0, render_ms = 0, encode_ms = 0, queue_ms = 0, gpu_ms = 0; // wire::Stages
    float decode_ms = 0;
    uint32_t bytes = 0; // message and JPEG
    uint16_t width = 0, height = 0;
    uint8_t quality = 0, views = 1;
    glm::vec3 position{0};
    glm::quat orientation{1, 0, 0, 0};
    float fov_y = 0;
    float error = 0, error_low = 0, error_high = 0; // wire::Frame::measured and its bounds; 0: not known

    // total_ms without the times of the server and the decoder: the network, both ways, and waiting in this client.
    std::optional<float> networkMs() const;
};

// Precondition: `message` is a frame.
FrameRecord recordOf(const Received& message, float decode_ms, uint64_t presented_us);

// The same of a picture that was drawn here. Precondition: `message` has lit particles.
FrameRecord recordOf(const Received& message, float draw_ms, uint64_t presented_us, const Pose& pose,
                     const Picture& picture);

// The smallest value that at least `fraction` of the values do not exceed (nearest rank); nothing for no values.
std::optional<float> percentile(std::vector<float> values, double fraction);

class Statistics {
public:
    explicit Statistics(std::string url) : url_(std::move(url)) {}

    void welcome(const Granted& granted);
    void frame(const FrameRecord& record);
    void dropped() { ++dropped_; } // counts a frame that a newer one replaced before it was shown
    void redrawn() { ++redrawn_; } // counts a picture of the display that was made from a frame's layers
    void error(const wire::Error& error);
    void roundTrip(std::optional<float> ms) {
        if (ms) round_trip_ms_ = ms;
    }
    void inputSent() { ++inputs_; }
    void ended(std::string why) { ended_ = std::move(why); }

    uint64_t frames() const { return frames_; }
    std::string lastError() const { return error_records_.empty() ? "" : error_records_.back().text; }
    double secondsShown() const; // from the first frame to the last
    double frameRate() const;    // frames a second from first to last; 0 for fewer than two frames
    // Frames a second, and the median latency, of the frames presented since `since_us`.
    double recentRate(uint64_t since_us) const;
    std::optional<float> recentLatencyMs(uint64_t since_us) const;

    // All of it: the content of stats.json.
    nlohmann::json json() const;
    // Two to four lines for a person. Precondition: frames() > 0.
    std::string summary() const;

private:
    const FrameRecord* lastMeasured() const; // null: no frame told its error
    std::vector<float> stage(std::optional<float> (*of)(const FrameRecord&)) const;

    // Ten minutes at 60 Hz. Percentiles and the list of frames cover the newest frames only, which bounds the memory.
    static constexpr size_t kMaxRecords = 36'000, kMaxErrors = 100;

    std::string url_, ended_;
    Granted granted_;
    std::string key_; // Granted::resume of the present connection
    uint32_t welcomes_ = 0, resumed_ = 0;
    uint64_t frames_ = 0, dropped_ = 0, redrawn_ = 0, bytes_ = 0, inputs_ = 0, errors_ = 0, first_us_ = 0;
    std::deque<FrameRecord> records_;
    struct ErrorRecord {
        wire::ErrorCode code;
        uint32_t input_seq;
        std::string text;
    };
    std::vector<ErrorRecord> error_records_;
    std::optional<float> round_trip_ms_;
};

} // namespace brume::client
