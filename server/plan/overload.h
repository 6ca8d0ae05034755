// Overload: how many steps of accuracy to give up, since frames take longer than the budget. It has no clock: callers
// pass the time.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace brume {

class Overload {
public:
    using Time = std::chrono::steady_clock::time_point;
    // `budget_ms`: device time that a frame of all viewers may take.
    explicit Overload(double budget_ms) : budget_ms_(budget_ms) {}

    void setBudget(double budget_ms) { budget_ms_ = budget_ms; }

    // A frame took `ms` at the present level. `restored`: predicted time one level lower / at this level, at least 1.
    // Returns true if the level changed, by one.
    // - Up: all frames of a second exceeded the budget.
    // - Down: for five seconds, the median of eleven frames, multiplied by `restored`, was below 4/5 of the budget.
    //   The median ignores frames that other programs made longer. Where the level rises again within ten seconds of
    //   that, twice as long as before must have been short, up to twenty minutes.
    // More than a second between two frames starts both times anew.
    bool took(double ms, double restored, Time now);
    // Takes the last step up back: the caller found no accuracy left to give up.
    void stepBack() { level_ -= level_ > 0; }

    uint32_t level() const { return level_; }

private:
    double median() const; // ms, of the newest frames

    double budget_ms_;
    uint32_t level_ = 0;
    Time last_{}, long_since_{}, short_since_{}, fell_{};
    std::chrono::seconds down_{5}; // of short frames, before the level falls
    bool long_ = false, short_ = false;
    std::array<double, 11> newest_{}; // ms, ring buffer
    size_t frames_ = 0;
};

} // namespace brume
