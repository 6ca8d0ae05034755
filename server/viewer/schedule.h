// Whose pictures a batch draws when it cannot draw everybody's: the earliest deadline first, until the device's time is spent. A
// machine without a clock of its own.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "server/viewer/frame.h"

namespace brume {

// A viewer's deadline is its own interval after it was last drawn: as many ticks as its quality allows, or so long that it takes
// no more than an equal part of the device, whichever is longer, but a second or half of the device at most; and not before it
// wanted a picture. While it waits its deadline stays and those of others, who are drawn, move on: nobody waits forever.
class Schedule {
public:
    // One viewer that is due, and its pictures.
    struct DrawRequest {
        uint32_t viewer = 0; // id
        double pixels = 0;   // of all its eyes
        uint32_t eyes = 1;
        uint64_t bytes = 0; // of its pictures on the device
        uint32_t every = 1; // ticks between its frames, at least
        uint32_t like = 0;  // number of the first request with the same pictures, which are drawn once
    };
    struct Limits {
        double budget_ms = 0;   // that a batch may take
        double dearer = 1;      // factor on what was measured: for pictures drawn otherwise
        uint32_t eyes = 64;     // of a batch
        uint64_t bytes = ~0ull; // of a batch's pictures; who exceeds them alone is drawn alone
    };

    // Numbers of the requests to draw now, in their order. All, when they fit or exceed the budget by half at most: a batch of
    // its own would cost the rest more than that. Else as many as fit, in the order of deadlines; the first one always, unless it
    // exceeds the budget alone, its deadline is to come and others want the device. `tick`: between two of the simulation's.
    std::span<const uint32_t> choose(std::span<const DrawRequest> requests, const Limits& limits, Clock::time_point now,
                                     Clock::duration tick);
    // Of the last choose(), in ms of the device, predicted: of all requests and of those chosen.
    double fullBatchMs() const { return full_batch_ms_; }
    double chosenMs() const { return chosen_ms_; }

    // Measured: this viewer's pictures of so many pixels, alone; and what the batch's viewers share.
    void took(uint32_t viewer, double pixels, double ms);
    void sharedTook(double ms);
    // Predicted, of a viewer's pictures; of one not measured yet: as the others' pixels. 0 while nothing is known.
    double predict(uint32_t viewer, double pixels) const;
    // Of the picture that it wanted last.
    double predict(uint32_t viewer) const;
    // How many viewers wanted pictures in the second before the last choose().
    uint32_t active() const { return active_; }

private:
    struct Turn {
        double ms_per_pixel = 0; // smoothed; 0: not measured
        double pixels = 0;       // of the last request
        Clock::time_point drawn{}, since{}, seen{};
        bool waits = false; // since `since`
    };
    Clock::time_point deadline(const DrawRequest& request, Clock::duration tick);

    std::map<uint32_t, Turn> turns_; // by viewer; those seen lately
    double shared_ms_ = 0, ms_per_pixel_ = 0, full_batch_ms_ = 0, chosen_ms_ = 0;
    uint32_t active_ = 0;
    std::vector<Clock::time_point> deadlines_;
    std::vector<uint32_t> order_, chosen_;
    std::vector<char> drawn_; // of a request: its pictures are in the batch
};

} // namespace brume
