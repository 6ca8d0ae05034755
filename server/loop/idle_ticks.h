// IdleTicks: ticks of this machine's clock while somebody looks. Nobody for two seconds: time stands still.
#pragma once

#include <functional>
#include <utility>

#include "server/loop/tick_source.h"

namespace brume {

class IdleTicks final : public TickSource {
public:
    static constexpr std::chrono::seconds kFallsAsleep{2};
    static constexpr std::chrono::milliseconds kLooksEvery{100};

    // `queue` outlives this. `wanted`: true while somebody looks, or has asked for something.
    IdleTicks(CommandQueue& queue, Clock::time_point begin, std::function<bool()> wanted)
        : queue_(queue), ticks_(queue, begin), wanted_(std::move(wanted)), wanted_at_(begin) {}

    Clock::time_point due() const override { return asleep_ ? look_at_ : ticks_.due(); }
    bool take(Clock::time_point now, std::vector<Command>& commands) override {
        if (wanted_()) {
            if (std::exchange(asleep_, false)) ticks_ = LocalTicks(queue_, now);
            wanted_at_ = now;
        } else if (now - wanted_at_ >= kFallsAsleep) {
            asleep_ = true;
            if (now >= look_at_) look_at_ = now + kLooksEvery;
            return false;
        }
        return ticks_.take(now, commands);
    }

private:
    CommandQueue& queue_;
    LocalTicks ticks_;
    const std::function<bool()> wanted_;
    bool asleep_ = false;
    Clock::time_point wanted_at_, look_at_{}; // last; when it looks again
};

} // namespace brume
