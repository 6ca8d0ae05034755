// ClusterTicks: the log as the source of ticks. They come when the log says so; no clock of this server makes any.
#pragma once

#include <algorithm>

#include "server/cluster/handover.h"
#include "server/loop/tick_source.h"

namespace brume::cluster {

class ClusterTicks final : public TickSource {
public:
    // `handover` outlives this.
    explicit ClusterTicks(Handover& handover) : handover_(handover) {}

    // About when the next one comes; then it is looked for every millisecond.
    Clock::time_point due() const override {
        if (handover_.behind() > 0) return Clock::time_point::min();
        return std::max(taken_ + kTick - kEarly, Clock::now() + (stands() ? kSeldom : kOften));
    }
    bool take(Clock::time_point now, std::vector<Command>& commands) override {
        if (!handover_.take(commands)) return false;
        taken_ = now;
        const uint64_t behind = handover_.behind();
        seeks_ = behind > (seeks_ ? kCaughtUp : kFarBehind);
        serves_ = behind <= (serves_ ? kTooFar : kCaughtUp);
        return true;
    }
    std::optional<std::vector<std::byte>> beginning() override {
        auto found = handover_.beginning();
        if (found) serves_ = false;
        return found;
    }
    bool stands() const override { return standstill() != nullptr; }
    bool seeks() const override { return seeks_ && !stands(); }
    const char* standstill() const override { return handover_.standstill(); }
    bool serves() const override { return serves_ && !handover_.aside(); }

private:
    static constexpr std::chrono::milliseconds kEarly{2}, kOften{1}, kSeldom{10};
    static constexpr uint64_t kFarBehind = 15, kCaughtUp = 2, kTooFar = 60; // ticks

    Handover& handover_;
    Clock::time_point taken_{};
    bool seeks_ = false;  // True: it has far to go, and draws nothing on the way
    bool serves_ = false; // False: it is not up to date yet, or not any more
};

} // namespace brume::cluster
