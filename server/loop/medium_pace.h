// MediumPace: for how long a picture shows the medium right, before it has moved on by itself. Viewers that redraw
// pictures for a camera that moves need new ones only so often.
#pragma once

#include <optional>
#include <vector>

#include "server/sim/simulation.h"
#include "server/viewer/frame.h"

namespace brume {

class MediumPace {
public:
    // To be called with each picture that may be redrawn; it compares some particles a few times a second. Allocates
    // nothing once they were looked at.
    void look(const Simulation& simulation);
    // A command changes what is seen: nothing is known of the next second.
    void disturb(Clock::time_point now) { disturbed_ = now; }
    // So long a picture stays right, at most kLongest. 0: not known, or less than a tick.
    Clock::duration lasts(Clock::time_point now) const;

    static constexpr std::chrono::milliseconds kLongest{200};

private:
    std::vector<gpu::Particle> before_, now_; // evenly chosen particles, at two ticks
    std::optional<uint64_t> tick_;            // of before_
    double change_ = 0;                       // of a particle in a second: RMS, in parts of its scale or extinction
    bool known_ = false;                      // True: change_ was found
    Clock::time_point disturbed_{};
};

} // namespace brume
