// What one viewer's pictures may cost: its JPEG quality, its size and its rate, from what its link and the device can do. A
// machine without a clock of its own.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "server/viewer/frame.h"

namespace brume {

// Less in this order: JPEG quality from what the viewer wishes for (75) down to 40, then half the size, then every second, fourth
// frame.
struct QualityStep {
    uint8_t quality = 100; // JPEG, at most; the viewer may wish for less
    bool half = false;     // of the size wished for, each side
    uint8_t every = 1;     // of the ticks, one frame
};

// What the device has to do, in ms: for this viewer's next picture, and for one picture of everybody.
struct DeviceLoad {
    double own_ms = 0, whole_ms = 0, budget_ms = 0;
    uint32_t viewers = 1;   // that share it
    bool exhausted = false; // the plan has no accuracy left to give up (Overload comes first)
};

class QualityControl {
public:
    static constexpr uint32_t kSteps = 7, kDeviceSteps = 4; // 0: the best
    static QualityStep stepAt(uint32_t level);
    // JPEG quality costs the device nothing: half the size, then every second, fourth frame.
    static QualityStep deviceStepAt(uint32_t level);

    // What happened since the last seen. Several times a second; acts every 250 ms. Down at once when the link queues or frames
    // were held back or replaced because of it; up by one after a second without, or after twice as long as before the last step
    // up when that had to be taken back within two seconds, up to 16 s: pictures do not swing between two sizes. True when a
    // level changed.
    struct Observation {
        float queue_ms = 0;      // on the link
        bool held_back = false;  // the window of bytes was closed when a pose waited
        bool superseded = false; // a frame was replaced before the socket took it
        // A limit of its own. Down at once while a frame of everybody takes more than one and a half budgets, the plan has given
        // up all it may, and this viewer takes more than an equal part; up after a second in which one step better would have
        // left a fifth of the budget. None: nothing is known.
        std::optional<DeviceLoad> device;
    };
    bool observe(const Observation& seen, Clock::time_point now);
    uint32_t level() const { return level_; }
    uint32_t deviceLevel() const { return device_level_; }
    QualityStep step() const; // the lesser of both limits

private:
    bool observeDevice(const DeviceLoad& load, Clock::time_point now);

    uint32_t level_ = 0, device_level_ = 0;
    Observation seen_; // the worst since the last act
    Clock::time_point acted_{}, clean_since_{}, room_since_{};
    std::optional<Clock::time_point> raised_;  // when it last went up, if it has not gone down since
    std::chrono::milliseconds patience_{1000}; // without queues, before the next step up
};

} // namespace brume
