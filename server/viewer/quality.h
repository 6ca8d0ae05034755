// What one viewer's pictures may cost: its JPEG quality, its size and its rate, from what its link can do. A machine
// without a clock of its own.
#pragma once

#include <algorithm>
#include <cstdint>

#include "server/viewer/frame.h"

namespace brume {

// Less in this order: JPEG quality from what the viewer wishes for (75) down to 40, then half the size, then every second, fourth
// frame.
struct QualityStep {
    uint8_t quality = 100; // JPEG, at most; the viewer may wish for less
    bool half = false;     // of the size wished for, each side
    uint8_t every = 1;     // of the ticks, one frame
};

class QualityControl {
public:
    static constexpr uint32_t kSteps = 7; // 0: the best
    static QualityStep stepAt(uint32_t level);

    // What happened since the last look. Several times a second; acts every 250 ms. Down at once when the link queues or frames
    // were held back or replaced because of it; up by one after a second without. True when the level changed.
    struct Look {
        float queue_ms = 0;      // on the link
        bool held_back = false;  // the window of bytes was closed when a pose waited
        bool superseded = false; // a frame was replaced before the socket took it
    };
    bool look(const Look& seen, Clock::time_point now);
    uint32_t level() const { return level_; }
    QualityStep step() const { return stepAt(level_); }

private:
    uint32_t level_ = 0;
    Look seen_; // the worst since the last act
    Clock::time_point acted_{}, clean_since_{};
};

} // namespace brume
