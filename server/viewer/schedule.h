// Chooses the viewers of a batch when it cannot draw all of them: earliest deadline first, until the budget is spent.
// It has no clock: callers pass the time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "server/viewer/frame.h"

namespace brume {

// The most that anybody gets when all get what they demand, but nobody more than that: the sum of min(demand, level) is
// `capacity`. Infinite where there is enough for all. Max-min fairness; O(n^2), allocates nothing.
double fairLevel(std::span<const double> demands, double capacity);

// Equal time for each viewer, where those who ask for the same pictures share their time; of those whose turn has come
// the earliest deadline first (worst-case fair queueing, Bennett and Zhang 1996):
//   turn     = the turn of its last frame + interval, and not before the viewer asked
//   deadline = turn + interval
//   interval = max(ticks that its quality allows, its part of the predicted time / its part of the device)
//   part     = what it demands, that time once a tick, but not more than the fair level of all active viewers
// So a small picture never waits for more than one dear one, and who comes anew is no better off than who stays.
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
        bool alone = false; // True: not together with others, and only in its turn where there are others
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
    // - Otherwise as many as fit. The first is taken in any case, unless it exceeds the budget alone, its turn is still
    //   to come, and other viewers are active.
    // - A request that wants to be alone is the only one when it comes first; it counts in no batch of all.
    // `tick`: duration of a simulation tick.
    std::span<const uint32_t> choose(std::span<const DrawRequest> requests, const Limits& limits, Clock::time_point now,
                                     Clock::duration tick);
    // Predicted device time of the last choose(): of a batch with all requests, and of the chosen one.
    double fullBatchMs() const { return full_batch_ms_; }
    double chosenMs() const { return chosen_ms_; }

    // Of the last choose(). True: somebody whose turn has come was left out. The device should not wait for the next
    // tick with it.
    bool someoneWaits() const { return someone_waits_; }

    // Predicted device time of a pixel, for as long as nothing was measured. What is no number says nothing.
    void expect(double ms_per_pixel) {
        if (ms_per_pixel_ == 0 && std::isfinite(ms_per_pixel)) ms_per_pixel_ = ms_per_pixel;
    }
    // Viewers that are not among these have left: they take no part any more. `viewers`: ids, ascending.
    void stay(std::span<const uint32_t> viewers);

    // Measured device time: of this viewer's pictures, of `pixels` in all; and of the work that the batch's viewers
    // share. `usual`: false if it says nothing of what other viewers' pictures take.
    void took(uint32_t viewer, double pixels, double ms, bool usual = true);
    void sharedTook(double ms);
    // Measured device time of finer pictures of this viewer, of `pixels` in all. Usual ones take no longer. A camera at
    // rest gets no usual ones.
    void finerTook(uint32_t viewer, double pixels, double ms);
    // Predicted device time (ms) of a viewer's pictures. A viewer not measured yet counts as the average one. 0:
    // nothing is known.
    double predict(uint32_t viewer, double pixels) const;
    // Its part of that for the pictures that it last asked for: those who ask for the same ones share the time. 0 for
    // an unknown viewer.
    double predictPart(uint32_t viewer) const;
    // Device time (ms) for viewers' own pictures in a batch of `most_ms`: what is left besides the work that they
    // share, and half of it at least, since smaller pictures do not make that work less.
    double forPictures(double most_ms) const { return std::max(most_ms - shared_ms_, most_ms / 2); }
    // Viewers for whom a batch has time within `most_ms` if each has pictures of `pixels`; nothing known: infinite.
    double viewersInTime(double pixels, double most_ms) const {
        return forPictures(most_ms) / (pixels * ms_per_pixel_);
    }
    // Viewers that asked for pictures in the second before the last choose(), and have not left.
    uint32_t active() const { return active_; }

private:
    // State of one viewer between batches.
    struct Turn {
        double ms_per_pixel = 0;                    // smoothed; 0: not measured
        double pixels = 0;                          // of its last request
        uint32_t sharers = 1;                       // who asked for the same pictures then, this one among them
        double every_ms = 0;                        // least time between its frames
        Clock::time_point began{}, since{}, seen{}; // began: the turn of its last frame
        bool waits = false;                         // True: asked at `since`, not drawn yet
    };
    void setTurns(std::span<const DrawRequest> requests, Clock::time_point now, Clock::duration tick);
    double fairPart(Clock::time_point now);
    double predictPart(uint32_t viewer, const Turn& turn) const;

    std::map<uint32_t, Turn> turns_; // by viewer; forgotten when it leaves, and 10 s after its last request
    double shared_ms_ = 0, ms_per_pixel_ = 0, full_batch_ms_ = 0, chosen_ms_ = 0;
    uint32_t active_ = 0;
    bool someone_waits_ = false;
    std::vector<Clock::time_point> turn_of_, deadlines_; // by request
    std::vector<double> demands_;                        // of active viewers, parts of the device
    std::vector<uint32_t> order_, chosen_;
    std::vector<char> drawn_;       // [request]: 1 if its pictures are in the batch
    std::vector<uint32_t> sharers_; // [request]: how many ask for the pictures of which it is the first
};

} // namespace brume
