// Whether pictures of a moving medium may be finer while all cameras rest: only in time of the device that nothing else needs. A
// machine without a clock of its own.
#pragma once

#include "server/viewer/frame.h"

namespace brume {

class Refinement {
public:
    // `part` of the frame budget that finer pictures of everybody may take; 0: never.
    explicit Refinement(double part) : part_(part) {}

    struct Observation {
        bool rests = false;   // no camera has moved for 150 ms, every viewer gets its best, and no accuracy is given up
        double plain_ms = 0;  // of a frame of all viewers as it is, measured
        double dearer = 1;    // what a finer one takes over that, predicted
        double budget_ms = 0; // of a frame
    };
    // Of the next batch. Begins when a fifth less than the part would do, goes on while the part does; once it was too dear, not
    // for five seconds.
    bool next(const Observation& seen, Clock::time_point now);
    // The finer batch took so long.
    void took(double ms) { measured_ms_ = measured_ms_ == 0 ? ms : measured_ms_ + 0.2 * (ms - measured_ms_); }

private:
    const double part_;
    bool on_ = false;
    double measured_ms_ = 0; // smoothed, since it began
    Clock::time_point stopped_{};
};

} // namespace brume
