#include "server/viewer/quality.h"

#include <utility>

namespace brume {
namespace {

constexpr std::chrono::milliseconds kActEvery{250}, kCleanFor{1000}, kTakenBack{2000}, kMostPatience{16000};
constexpr float kQueueTooLong = 50, kQueueClean = 20; // ms
constexpr double kTooMuch = 1.5, kSpare = 0.8;        // parts of the frame budget

QualityStep keepingSize(QualityStep step, bool keeps_size) {
    if (keeps_size && std::exchange(step.half, false)) step.every = uint8_t(4 * step.every);
    return step;
}

} // namespace

QualityStep QualityControl::stepAt(uint32_t level) {
    constexpr QualityStep kAll[kSteps] = {{100, false, 1}, {65, false, 1}, {52, false, 1}, {40, false, 1},
                                          {40, true, 1},   {40, true, 2},  {40, true, 4}};
    return kAll[std::min(level, kSteps - 1)];
}

QualityStep QualityControl::deviceStepAt(uint32_t level) {
    constexpr QualityStep kAll[kDeviceSteps] = {{100, false, 1}, {100, true, 1}};
    return kAll[std::min(level, kDeviceSteps - 1)];
}

QualityStep QualityControl::step(bool keeps_size) const {
    QualityStep least = linkStep(keeps_size);
    const QualityStep device = deviceStepAt(device_level_);
    least.quality = std::min(least.quality, device.quality);
    least.half |= device.half && !keeps_size;
    least.every = std::max(least.every, device.every);
    return least;
}

QualityStep QualityControl::linkStep(bool keeps_size) const { return keepingSize(stepAt(level_), keeps_size); }

Reduced QualityControl::reduced() const {
    const QualityStep link = stepAt(level_), device = deviceStepAt(device_level_);
    if (device.half > link.half || device.every > link.every) return Reduced::device;
    return level_ > 0 ? Reduced::link : device_level_ > 0 ? Reduced::device : Reduced::no;
}

bool QualityControl::observeDevice(const DeviceLoad& load, Clock::time_point now) {
    // Going back makes the picture four times as large: it takes as long as before, at most four times as long.
    const double more =
        device_level_ > 0 && !stepAt(level_).half ? std::clamp(whole_size_ms_ - load.own_ms, 0.0, 3 * load.own_ms) : 0;
    const double most = kTooMuch * load.budget_ms;
    const bool over = load.exhausted && load.whole_ms > most && load.own_ms * load.viewers > load.budget_ms;
    const bool room = load.whole_ms == 0 || load.whole_ms + more < kSpare * most;
    if (!room) room_since_ = now;
    if (over && device_level_ + 1 < kDeviceSteps) {
        if (device_level_++ == 0) whole_size_ms_ = load.own_ms;
        if (device_raised_)
            device_patience_ =
                now - *device_raised_ < kTakenBack ? std::min(2 * device_patience_, kMostPatience) : kCleanFor;
        device_raised_.reset();
    } else if (room && device_level_ > 0 && now - room_since_ >= device_patience_) {
        --device_level_;
        device_raised_ = room_since_ = now;
    } else {
        return false;
    }
    return true;
}

bool QualityControl::observe(const Observation& seen, Clock::time_point now) {
    seen_ = {std::max(seen_.queue_ms, seen.queue_ms), seen_.held_back || seen.held_back,
             seen_.superseded || seen.superseded, seen.device ? seen.device : seen_.device};
    if (seen_.queue_ms > kQueueClean || seen_.held_back || seen_.superseded) clean_since_ = now;
    if (now - acted_ < kActEvery) return false;
    const uint32_t before = level_;
    const bool bad = seen_.queue_ms > kQueueTooLong || seen_.held_back || seen_.superseded;
    if (bad && level_ + 1 < kSteps) {
        ++level_;
        if (raised_) patience_ = now - *raised_ < kTakenBack ? std::min(2 * patience_, kMostPatience) : kCleanFor;
        raised_.reset();
    } else if (!bad && level_ > 0 && now - clean_since_ >= patience_) {
        --level_;
        raised_ = clean_since_ = now; // the wait for the next step begins anew
    }
    const bool device_changed = seen_.device && observeDevice(*seen_.device, now);
    acted_ = now;
    seen_ = {};
    return level_ != before || device_changed;
}

} // namespace brume
