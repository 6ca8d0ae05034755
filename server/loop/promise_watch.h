// PromiseWatch: when the measured error of pictures breaks what render.error promises, and when it no longer does. It
// has no clock: callers pass the time.
#pragma once

#include <chrono>
#include <optional>
#include <span>
#include <string>

#include "server/error/error_window.h"

namespace brume {

// Of those by `method` that are known, the one with the largest lower bound; null: there is none.
const ViewError* worstOf(std::span<const ViewError> errors, const std::string& method);

class PromiseWatch {
public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr std::chrono::seconds kBroken{2}; // for so long, before it is said
    static constexpr std::chrono::seconds kApart{60}; // from one broken promise that is said to the next

    struct Seen {
        double promised = 0;              // relative RMSE; 0: nothing is promised
        const ViewError* worst = nullptr; // null: nothing is known
        bool relaxed = false;             // True: accuracy is given up under overload
    };
    // A line for the log.
    struct Line {
        bool broken = false; // True: the promise is broken; false: it holds again
        std::string text;
    };
    // What is to be said now. Pictures of another promise, or of overload, leave the measurement before it is judged.
    std::optional<Line> look(const Seen& seen, Time now);

private:
    std::optional<double> promised_; // as last seen
    std::optional<Time> unjudged_;   // nothing is judged until then
    std::optional<Time> above_;      // since when the lower bound has been above the promise
    std::optional<Time> last_said_;  // when a broken promise was last said
    bool broken_ = false;            // True: that it is broken was said, and not yet that it holds again
};

} // namespace brume
