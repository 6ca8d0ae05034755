// How much may be on its way to one viewer: frames and bytes, from what its link does. A machine without a clock of its own.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/viewer/frame.h"

namespace brume {

struct PacingOptions {
    uint32_t least_frames = 2, most_frames = 6;   // in flight: handed out to be rendered and not yet acknowledged
    std::chrono::milliseconds grow_below{5};      // queueing on the link: under it more bytes may be on their way,
    std::chrono::milliseconds shrink_above{50};   // over it fewer
    std::chrono::milliseconds base_window{10000}; // the least round trip of so long is the link without queues
    std::chrono::milliseconds silent{2000}; // without an acknowledgement, or 8 round trips if that is longer: render no more
};

// The window of frames covers the time from a frame handed out to its acknowledgement without queues: round trip, stages, and one
// more frame to come. Where it cannot cover that at 60 Hz, its frames are spread: they come evenly, not in bursts. The window of
// bytes follows the queueing delay, by a frame at a time: over a link that cannot carry what the server makes, frames get fewer
// instead of older. Round trips are pings', which pass through the same queues, never acknowledgements', which wait for the
// viewer's display.
class Pacing {
public:
    explicit Pacing(const PacingOptions& options) : options_(options), frames_(options.least_frames) {
        flight_.reserve(options.most_frames + 1);
    }

    // A frame is handed out to be rendered.
    void issued(uint32_t id, Clock::time_point now);
    // It goes to the socket: `bytes`, `stages_ms` since it was handed out and what the viewer's display is going to take.
    void sent(uint32_t id, size_t bytes, float stages_ms, Clock::time_point now);
    // It will never be: superseded, or it could not be made.
    void dropped(uint32_t id);
    // The viewer has this one and all before it. How many were in flight.
    size_t acknowledged(uint32_t id, Clock::time_point now);
    // A round trip of a ping. `most_queue`: what of it the link's queue can be, from elsewhere; the rest was the program at the
    // other end, which smaller frames do not help.
    using Millis = std::chrono::duration<float, std::milli>;
    void ponged(Millis round_trip, Clock::time_point now, Millis most_queue = Millis::max());
    // Frames are about to become larger: no more bytes may be on their way than filled the window so far, until pings find that
    // the link carries them. To be held by that says nothing of the link for as many pings.
    void probe();
    void clear() { flight_.clear(); }

    // Whether one more frame may be rendered.
    bool isOpen(Clock::time_point now) const;
    // Whether bytes alone forbid it, and not because of probe().
    bool isHeldByBytes() const;
    // Whether frames wait for an acknowledgement that should have come.
    bool isSilent(Clock::time_point now) const { return silence(now) > silenceAllowed(); }
    // Since when nothing was acknowledged although something was sent; zero when nothing waits.
    Clock::duration silence(Clock::time_point now) const;

    uint32_t inFlight() const { return uint32_t(flight_.size()); }
    size_t bytesInFlight() const;
    uint32_t frames() const { return frames_; }            // the window
    std::optional<size_t> bytes() const { return bytes_; } // and that of bytes; none while nothing queues
    float baseRoundTripMs() const { return base_ms_; }     // 0 before the first pong
    float queueMs() const { return queue_ms_; }            // of the last pong

private:
    struct Frame {
        uint32_t id;
        size_t bytes; // 0 until it is sent
        Clock::time_point issued, sent;
    };
    struct Least { // round trip of a tenth of the base's window
        int64_t slot = -1;
        float ms = 0;
    };
    Clock::duration silenceAllowed() const;
    float tripMs() const { return base_ms_ + stages_ms_; } // of a frame handed out, to its acknowledgement, without queues
    bool exceedsBytes() const;
    void fitFrames();
    void fitBytes(size_t frame);

    const PacingOptions options_;
    std::vector<Frame> flight_;
    std::array<Least, 10> least_;
    float base_ms_ = 0, queue_ms_ = 0, stages_ms_ = 0, interval_ms_ = 1000.0f / 60, frame_bytes_ = 0;
    uint32_t frames_;
    std::optional<size_t> bytes_;
    Clock::time_point last_issued_{}, last_ack_{};
    bool acknowledged_ = false; // something, since the window of bytes last changed
    uint32_t probing_ = 0;      // pings that are still to come of a probe
};

} // namespace brume
