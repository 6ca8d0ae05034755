#include "server/viewer/pacing.h"

#include <algorithm>
#include <cmath>

namespace brume {
namespace {

constexpr float kSmoothing = 0.1f;
constexpr float kDisplayMs = 1000.0f / 60;
constexpr uint32_t kProbe = 3;   // pings that are waited for after probe()
constexpr float kSpread = 0.75f; // least interval of frames / even interval; below 1, so that a late viewer catches up

} // namespace

void Pacing::issued(uint32_t id, Clock::time_point now) {
    if (last_issued_ != Clock::time_point{}) {
        const float interval = std::min(Millis(now - last_issued_).count(), 1000.0f);
        interval_ms_ += kSmoothing * (interval - interval_ms_);
    }
    last_issued_ = now;
    flight_.push_back({id, 0, now, {}});
}

void Pacing::sent(uint32_t id, size_t bytes, float stages_ms, Clock::time_point now) {
    for (Frame& frame : flight_)
        if (frame.id == id) frame.bytes = std::max<size_t>(bytes, 1), frame.sent = now;
    frame_bytes_ = frame_bytes_ == 0 ? float(bytes) : frame_bytes_ + kSmoothing * (float(bytes) - frame_bytes_);
    stages_ms_ += kSmoothing * (stages_ms - stages_ms_);
    fitFrames();
}

void Pacing::dropped(uint32_t id) {
    std::erase_if(flight_, [&](const Frame& frame) { return frame.id == id; });
}

size_t Pacing::acknowledged(uint32_t id, Clock::time_point now) {
    last_ack_ = now;
    acknowledged_ = true;
    return std::erase_if(flight_, [&](const Frame& frame) { return !isNewer(frame.id, id); });
}

void Pacing::ponged(Millis round_trip, Clock::time_point now, Millis most_queue) {
    const float ms = std::max(round_trip.count(), 0.0f);
    const int64_t slot = now.time_since_epoch() / (options_.base_window / int(least_.size()));
    Least& least = least_[size_t(slot) % least_.size()];
    if (least.slot != slot) least = {slot, ms};
    least.ms = std::min(least.ms, ms);
    base_ms_ = ms;
    for (const Least& l : least_)
        if (l.slot >= 0 && slot - l.slot < int64_t(least_.size())) base_ms_ = std::min(base_ms_, l.ms);
    queue_ms_ = std::min(ms - base_ms_, most_queue.count());
    probing_ -= std::min(probing_, 1u);
    fitFrames();
    fitBytes(size_t(frame_bytes_));
}

void Pacing::probe() {
    if (bytes_ || frame_bytes_ == 0) return;
    bytes_ = size_t(float(frames_) * frame_bytes_);
    probing_ = kProbe;
}

void Pacing::fitFrames() {
    const float frames = std::ceil(tripMs() / std::max(interval_ms_, kDisplayMs)) + 1;
    frames_ = uint32_t(std::clamp(frames, float(options_.least_frames), float(options_.most_frames)));
}

// Changes the window of bytes at most once after each acknowledgement: without one, the queue's length is no news.
void Pacing::fitBytes(size_t frame) {
    if (!acknowledged_ || frame == 0) return;
    if (queue_ms_ > Millis(options_.shrink_above).count()) {
        const size_t now = bytes_ ? *bytes_ : frames_ * frame;
        bytes_ = std::max(now > frame ? now - frame : 0, frame);
        acknowledged_ = false;
    } else if (bytes_ && queue_ms_ < Millis(options_.grow_below).count()) {
        *bytes_ += frame;
        if (*bytes_ >= (options_.most_frames + 1) * frame) bytes_.reset(); // the window of frames is narrower
        acknowledged_ = false;
    }
}

bool Pacing::isOpen(Clock::time_point now) const {
    if (flight_.size() >= frames_ || isSilent(now)) return false;
    const float even = tripMs() / float(frames_); // ms between frames if the window's frames were evenly spaced
    if (even > kDisplayMs && now - last_issued_ < Millis(kSpread * even)) return false;
    return !exceedsBytes();
}

bool Pacing::isHeldByBytes() const { return probing_ == 0 && exceedsBytes(); }

bool Pacing::exceedsBytes() const {
    // The next frame, and frames whose size is not known yet, count with the mean size of earlier frames.
    return bytes_ && !flight_.empty() && bytesInFlight() + size_t(frame_bytes_) > *bytes_;
}

size_t Pacing::bytesInFlight() const {
    size_t bytes = 0;
    for (const Frame& frame : flight_) bytes += frame.bytes ? frame.bytes : size_t(frame_bytes_);
    return bytes;
}

Clock::duration Pacing::silence(Clock::time_point now) const {
    for (const Frame& frame : flight_)
        if (frame.sent != Clock::time_point{})
            return std::max(now - std::max(frame.sent, last_ack_), Clock::duration::zero());
    return Clock::duration::zero();
}

Clock::duration Pacing::silenceAllowed() const {
    const auto trips = std::chrono::duration_cast<Clock::duration>(Millis(8 * (base_ms_ + queue_ms_)));
    return std::max<Clock::duration>(options_.silent, trips);
}

} // namespace brume
