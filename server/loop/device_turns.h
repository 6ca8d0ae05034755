// DeviceTurns: which of several frame loops has the device next. Each has a part of its time in the ratio of weights:
// of those that wait, the one whose time over weight is least (start-time fair queueing: Goyal, Vin and Cheng 1996).
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>

namespace brume {

// Thread-safe. A loop that is alone never waits.
class DeviceTurns {
public:
    using Time = std::chrono::steady_clock::time_point;

    // A loop's place among the others. It lives no longer than its DeviceTurns.
    class Seat {
    public:
        // `wake` is called, by any thread and under a lock, when it may be this seat's turn. It must not call a Seat.
        Seat(DeviceTurns& turns, std::function<void()> wake);
        ~Seat();
        Seat(const Seat&) = delete;
        Seat& operator=(const Seat&) = delete;

        // Takes the device, if nobody has it and it is this seat's turn. Otherwise it is waited for. Who has it gives
        // it back by that, and may have it again. `weight`: above 0.
        bool take(double weight, Time now);
        // Gives it back, if this seat has it. The time since take() is booked.
        void give(Time now);
        // This seat's part of the weights of all that have waited for the device within a second, itself among them.
        double part(Time now) const;

    private:
        DeviceTurns& turns_;
        const uint32_t number_;
    };

private:
    struct Entry {
        std::function<void()> wake;
        double weight = 1;
        double time = 0; // ms of the device over weight
        bool waits = false;
        Time wanted{};  // when it was last asked for
        Time offered{}; // since when it is this seat's turn; 0: it is not
    };
    using Entries = std::map<uint32_t, Entry>;

    // Preconditions of all: mutex_ is held.
    Entries::iterator next(Time now);
    void book(Time now);
    void wakeOthers(uint32_t but);

    mutable std::mutex mutex_;
    Entries entries_;
    uint32_t next_number_ = 1, holder_ = 0; // 0: nobody has the device
    Time taken_{};
    double now_ = 0; // Entry::time of the last who took the device
};

} // namespace brume
