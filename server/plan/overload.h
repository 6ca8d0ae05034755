// When frames take longer than viewers can wait: how many steps of accuracy to give up. Times are the caller's, so that a test
// has its own.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace brume {

class Overload {
public:
    using Time = std::chrono::steady_clock::time_point;
    // `budget_ms`: that a frame of all viewers may take.
    explicit Overload(double budget_ms) : budget_ms_(budget_ms) {}

    void setBudget(double budget_ms) { budget_ms_ = budget_ms; }

    // A frame took `ms` at the present level. `restored`: what it would take one level lower over what it takes, predicted, >= 1.
    // True when the level changed: by one, up after frames of a second that were all too long, down after five seconds in which
    // most (the median of eleven: what else a machine does makes some longer) would have been short enough one level lower, by a
    // fifth. More than a second between two frames starts anew.
    bool took(double ms, double restored, Time now);
    // The last step changed nothing, since there is nothing left to give up.
    void stepBack() { level_ -= level_ > 0; }

    uint32_t level() const { return level_; }

private:
    double median() const; // of the newest frames

    double budget_ms_;
    uint32_t level_ = 0;
    Time last_{}, long_since_{}, short_since_{};
    bool long_ = false, short_ = false;
    std::array<double, 11> newest_{}; // ms, a ring
    size_t frames_ = 0;
};

} // namespace brume
