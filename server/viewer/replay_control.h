// What viewers may ask of a replay that is looked at: pause, go on, go to a tick. Connections ask, the frame loop's
// thread answers. Thread-safe.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

namespace brume {

class ReplayControl {
public:
    // Ticks of the recording's first and last state.
    ReplayControl(uint64_t first_tick, uint64_t last_tick) : first(first_tick), last(last_tick) {}

    const uint64_t first, last;
    std::atomic<bool> paused{false}; // True: no tick is taken but on the way of a seek

    struct Seek {
        uint64_t number = 0; // counted from 1; 0: there was none
        uint64_t tick = 0;
    };
    struct Reached {
        uint64_t number = 0; // of the seek
        uint64_t tick = 0, state_hash = 0;
    };
    // Replaces a seek that is not reached. Returns its number. Precondition: first <= tick <= last.
    uint64_t seek(uint64_t tick) {
        const std::scoped_lock lock(mutex_);
        wanted_ = {wanted_.number + 1, tick};
        return wanted_.number;
    }
    Seek wanted() const {
        const std::scoped_lock lock(mutex_);
        return wanted_;
    }
    void arrived(const Reached& reached) {
        const std::scoped_lock lock(mutex_);
        reached_ = reached;
    }
    Reached reached() const {
        const std::scoped_lock lock(mutex_);
        return reached_;
    }

private:
    mutable std::mutex mutex_;
    Seek wanted_;
    Reached reached_;
};

} // namespace brume
