// Decides if pictures of a moving medium are drawn with less error while all cameras rest, in device time that
// nothing else needs. It has no clock: callers pass the time.
#pragma once

#include "server/viewer/frame.h"

namespace brume {

class Refinement {
public:
    // `part`: the part of the frame budget that finer pictures of all viewers may take; 0: never.
    explicit Refinement(double part) : part_(part) {}

    struct Observation {
        bool rests = false;   // True: no camera moved for 150 ms, every viewer has full quality, and overload is off
        double plain_ms = 0;  // measured time of a usual frame of all viewers
        double dearer = 1;    // predicted time of a finer frame / of a usual one
        double budget_ms = 0; // of a frame of all viewers
    };
    // True if the next batch is drawn finer. Begins when the predicted time is at most 4/5 of the part, and goes on
    // while the measured time is within the part. After a batch that took longer it pauses for five seconds.
    bool next(const Observation& seen, Clock::time_point now);
    // Measured time of a finer batch of all viewers.
    void took(double ms) { measured_ms_ = measured_ms_ == 0 ? ms : measured_ms_ + 0.2 * (ms - measured_ms_); }

private:
    const double part_;
    bool on_ = false;
    double measured_ms_ = 0; // smoothed, since finer batches began
    Clock::time_point stopped_{};
};

} // namespace brume
