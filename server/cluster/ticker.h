// Ticker: when this server publishes which `advance`, as the one that makes the ticks or to become it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "server/loop/tick_source.h"

namespace brume::cluster {

class Ticker {
public:
    using Time = Clock::time_point;

    explicit Ticker(Time begin) : ticked_(begin), next_(begin) {}

    struct Now {
        bool mine = false;   // True: this server makes the ticks
        size_t rank = 0;     // Log::rank()
        uint64_t tick = 0;   // Log::tick()
        uint64_t behind = 0; // ticks of the log that this server has not simulated
    };
    // The tick to advance to. Nothing: none is due, or so many are on their way that more would not help.
    std::optional<uint64_t> due(Time time, const Now& now) {
        const auto patience = kPatience * int64_t(now.mine ? 1 : 1 + now.rank);
        if (time - std::max(ticked_, tried_) >= patience) { // nobody makes them, or what was published is lost
            tried_ = time;
            next_ = time + kTick;
            published_ = now.tick;
        } else if (!now.mine || time < next_) {
            return {};
        } else {
            if (time - next_ > kMostBehind) next_ = time;
            next_ += kTick;
        }
        published_ = std::max(published_, now.tick);
        if (published_ - now.tick >= kMostAhead || now.behind >= kMostAhead) return {};
        return ++published_;
    }
    // An `advance` had an effect, whosesoever it was.
    void ticked(Time time) { ticked_ = time; }
    Time lastTick() const { return ticked_; }
    Time next() const { return next_; } // when due() has something, for who makes the ticks

private:
    static constexpr std::chrono::milliseconds kPatience{150};
    static constexpr std::chrono::milliseconds kMostBehind{250}; // then time passes without ticks, as with LocalTicks
    static constexpr uint64_t kMostAhead = 15;

    Time ticked_, next_, tried_{};
    uint64_t published_ = 0; // the last tick that was
};

} // namespace brume::cluster
