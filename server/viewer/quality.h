// Chooses JPEG quality, size and rate of one viewer's pictures from what its link and the device can carry. It has no
// clock: callers pass the time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "server/viewer/frame.h"

namespace brume {

// How far pictures are reduced. The order for a slow link: first JPEG quality, from what the viewer asked for (75) down
// to 40; then half the size; then every second, every fourth tick.
struct QualityStep {
    uint8_t quality = 100; // most JPEG quality; the viewer may ask for less
    bool half = false;     // True: half the width and half the height
    uint8_t every = 1;     // ticks between frames, at least
};

// The device's load. Times in ms, predicted: of this viewer's next frame, of a frame of all viewers, and what that
// may take.
struct DeviceLoad {
    double own_ms = 0, whole_ms = 0, budget_ms = 0;
    uint32_t viewers = 1;   // viewers that share the device
    bool exhausted = false; // True: the plan has no accuracy left to give up (Overload comes first)
};

class QualityControl {
public:
    static constexpr uint32_t kSteps = 7, kDeviceSteps = 2; // level 0 is the best
    // The steps for a slow link, `level` < kSteps.
    static QualityStep stepAt(uint32_t level);
    // The steps for a busy device, `level` < kDeviceSteps: half the size. JPEG quality costs the device nothing, and
    // Schedule gives each viewer its part of the device's time.
    static QualityStep deviceStepAt(uint32_t level);

    // What happened since the last call of observe().
    struct Observation {
        float queue_ms = 0;               // queueing delay of the link
        bool held_back = false;           // True: a request waited since the window of bytes was full
        bool superseded = false;          // True: a newer frame replaced one that the socket had not taken
        std::optional<DeviceLoad> device; // nothing: not known
    };
    // To be called several times a second; acts every 250 ms. Returns true when a level changed. Two levels are kept.
    // - Link. One step down at once when it queues more than 50 ms, or when frames were held back or superseded. One
    //   step up after a second without. When a step up had to be taken back within two seconds, the next one waits
    //   twice as long, at most 16 s: pictures do not swing between two sizes.
    // - Device. Half the size at once if a frame of all viewers takes more than 1.5 budgets, the plan is exhausted,
    //   and this viewer takes more than an equal share. The whole size after a second in which that would have left a
    //   fifth of it. If that is taken back, the next time is waited for longer, as for the link.
    bool observe(const Observation& seen, Clock::time_point now);
    uint32_t level() const { return level_; }
    uint32_t deviceLevel() const { return device_level_; }
    // The lower of both levels' steps, in each part. `keeps_size`: true for the whole size. A slow link then gets a
    // quarter of the rate in place of half the sides, which is as many pixels a second.
    QualityStep step(bool keeps_size = false) const;
    // The link's step alone: of a picture that comes once, which is no load that lasts.
    QualityStep linkStep(bool keeps_size = false) const;
    // What has the lower step in size and rate; the link where they are equal, since it has JPEG quality besides.
    Reduced reduced() const;

private:
    bool observeDevice(const DeviceLoad& load, Clock::time_point now);

    uint32_t level_ = 0, device_level_ = 0;
    Observation seen_; // the worst values since a level was last decided
    Clock::time_point acted_{}, clean_since_{}, room_since_{};
    std::optional<Clock::time_point> raised_;         // when the link's level last improved; nothing once it went down
    std::chrono::milliseconds patience_{1000};        // time without queues before the next step up
    std::optional<Clock::time_point> device_raised_;  // the same for the device's level
    std::chrono::milliseconds device_patience_{1000}; // time with room before the next step up
    double whole_size_ms_ = 0;                        // DeviceLoad::own_ms when pictures were last of their whole size
};

} // namespace brume
