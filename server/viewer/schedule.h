// Chooses the viewers of a batch when it cannot draw all of them: earliest deadline first, until the budget is spent.
// It has no clock: callers pass the time.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "server/viewer/frame.h"

namespace brume {

// Earliest deadline first:
//   deadline = last frame + interval, and not before the viewer asked
//   interval = max(ticks that its quality allows, its predicted time x active viewers), at most max(1 s, 2 x that time)
// A waiting viewer's deadline stays, while those of drawn viewers move on: nobody waits forever.
class Schedule {
public:
    // The pictures that one due viewer asks for.
    struct DrawRequest {
        uint32_t viewer = 0; // its id
        double pixels = 0;   // of all its eyes together
        uint32_t eyes = 1;
        uint64_t bytes = 0; // device memory for its pictures
        uint32_t every = 1; // least ticks between its frames
        uint32_t like = 0;  // index of the first request with the same pictures: they are drawn once
    };
    struct Limits {
        double budget_ms = 0;   // most predicted time of a batch
        double dearer = 1;      // factor on predicted times, for pictures with less error than those measured
        uint32_t eyes = 64;     // most of a batch
        uint64_t bytes = ~0ull; // most of a batch's pictures; a larger request is drawn alone
    };

    // Chooses requests for the next batch; returns their indices, earliest deadline first.
    // - All of them, when they fit or exceed the budget by no more than half: a second batch would cost the others
    //   more.
    // - Otherwise as many as fit. The first is taken in any case, unless it exceeds the budget alone, its deadline is
    //   still to come, and other viewers are active.
    // `tick`: duration of a simulation tick.
    std::span<const uint32_t> choose(std::span<const DrawRequest> requests, const Limits& limits, Clock::time_point now,
                                     Clock::duration tick);
    // Predicted device time of the last choose(): of a batch with all requests, and of the chosen one.
    double fullBatchMs() const { return full_batch_ms_; }
    double chosenMs() const { return chosen_ms_; }

    // Measured device time: of this viewer's pictures, of `pixels` in all; and of the work that the batch's viewers
    // share.
    void took(uint32_t viewer, double pixels, double ms);
    void sharedTook(double ms);
    // Predicted device time (ms) of a viewer's pictures. A viewer not measured yet counts as the average one. 0:
    // nothing is known.
    double predict(uint32_t viewer, double pixels) const;
    // The same for the pictures that the viewer last asked for; 0 for an unknown viewer.
    double predict(uint32_t viewer) const;
    // Viewers that asked for pictures in the second before the last choose().
    uint32_t active() const { return active_; }

private:
    // State of one viewer between batches.
    struct Turn {
        double ms_per_pixel = 0; // smoothed; 0: not measured
        double pixels = 0;       // of its last request
        Clock::time_point drawn{}, since{}, seen{};
        bool waits = false; // True: asked at `since`, not drawn yet
    };
    Clock::time_point deadline(const DrawRequest& request, Clock::duration tick);

    std::map<uint32_t, Turn> turns_; // by viewer; forgotten 10 s after the last request
    double shared_ms_ = 0, ms_per_pixel_ = 0, full_batch_ms_ = 0, chosen_ms_ = 0;
    uint32_t active_ = 0;
    std::vector<Clock::time_point> deadlines_;
    std::vector<uint32_t> order_, chosen_;
    std::vector<char> drawn_; // [request]: 1 if its pictures are in the batch
};

} // namespace brume
