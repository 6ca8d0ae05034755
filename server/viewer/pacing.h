// Limits how many frames and bytes are in flight to one viewer, from the round trips and queues of its link. It has
// no clock: callers pass the time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/viewer/frame.h"

namespace brume {

struct PacingOptions {
    uint32_t least_frames = 2, most_frames = 6;   // limits of the window; in flight: handed out, not yet acknowledged
    std::chrono::milliseconds grow_below{5};      // queueing delay below which the window of bytes grows
    std::chrono::milliseconds shrink_above{50};   // queueing delay above which it shrinks
    std::chrono::milliseconds base_window{10000}; // the least round trip in so long is taken for that without queues
    std::chrono::milliseconds silent{2000};       // without an acknowledgement for so long, or for 8 round
                                                  // trips if that is longer, rendering stops
};

// Two windows bound what is in flight.
// - Frames: enough for the time from handing a frame out to its acknowledgement without queues (round trip + stages),
//   and one more. Where that many would not make 60 Hz, frames are spaced evenly instead of coming in bursts.
// - Bytes: follows the queueing delay, one frame's size at a time. Over a link that is too slow, frames get fewer,
//   not older.
// Pings measure round trips, since they pass through the same queues as frames. Acknowledgements do not, since they
// wait for the viewer's display.
class Pacing {
public:
    explicit Pacing(const PacingOptions& options) : options_(options), frames_(options.least_frames) {
        flight_.reserve(options.most_frames + 1);
    }

    // Frame `id` was handed out to be rendered.
    void issued(uint32_t id, Clock::time_point now);
    // Frame `id` goes to the socket. `stages_ms`: time since it was handed out, plus the expected wait for the
    // viewer's display.
    void sent(uint32_t id, size_t bytes, float stages_ms, Clock::time_point now);
    // Frame `id` will never be sent: it was superseded, or it could not be drawn.
    void dropped(uint32_t id);
    // The viewer has presented frame `id` and all before it. Returns how many of these were in flight.
    size_t acknowledged(uint32_t id, Clock::time_point now);
    // A ping came back. `most_queue`: an upper bound, known to the caller, of the part of the round trip that the
    // link's queue took. The rest was spent by the program at the other end, and smaller frames would not shorten it.
    using Millis = std::chrono::duration<float, std::milli>;
    void ponged(Millis round_trip, Clock::time_point now, Millis most_queue = Millis::max());
    // To be called before frames become larger. Bounds the bytes in flight by what the window of frames held so far,
    // until pings show that the link carries more. While it probes (three pings), isHeldByBytes() is false.
    void probe();
    void clear() { flight_.clear(); }

    // True if one more frame may be rendered now.
    bool isOpen(Clock::time_point now) const;
    // True if the window of bytes forbids a frame, and not only because of probe().
    bool isHeldByBytes() const;
    // True if an acknowledgement is overdue (PacingOptions::silent).
    bool isSilent(Clock::time_point now) const { return silence(now) > silenceAllowed(); }
    // Time without an acknowledgement while sent frames wait for one; zero when none waits.
    Clock::duration silence(Clock::time_point now) const;

    uint32_t inFlight() const { return uint32_t(flight_.size()); }
    size_t bytesInFlight() const;
    uint32_t frames() const { return frames_; }            // window of frames
    std::optional<size_t> bytes() const { return bytes_; } // window of bytes; nothing: no limit
    float baseRoundTripMs() const { return base_ms_; }     // 0 before the first pong
    float queueMs() const { return queue_ms_; }            // queueing delay of the last ping

private:
    struct Frame {
        uint32_t id;
        size_t bytes; // 0 until it is sent
        Clock::time_point issued, sent;
    };
    struct Least { // least round trip in one slot, a tenth of base_window
        int64_t slot = -1;
        float ms = 0;
    };
    Clock::duration silenceAllowed() const;
    float tripMs() const { return base_ms_ + stages_ms_; } // frame handed out to acknowledged, without queues
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
    bool acknowledged_ = false; // True: a frame was acknowledged since the window of bytes changed
    uint32_t probing_ = 0;      // pings until the probe ends
};

} // namespace brume
