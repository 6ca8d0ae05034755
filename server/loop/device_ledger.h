// Where the device's time goes: to which passes, and to which viewers.
#pragma once

#include <span>
#include <vector>

#include "server/gpu/pass_sample.h"
#include "server/loop/batch_planner.h"

namespace brume {

class DeviceLedger {
public:
    struct Times {
        double shared_ms = 0; // of passes once for all
        double views_ms = 0;  // of passes for each view
        double shown_ms = 0;  // the part of them for views of how a picture is made
        double all() const { return shared_ms + views_ms; }
    };
    // Takes the times of a batch's passes: gives each job its gpu_ms, where passes that draw several views together
    // count by pixels, and smooths the times of passes.
    Times book(std::span<const gpu::PassSample> samples, BatchContents& batch);

    // Every pass there ever was: ms of the device for one view, or for all, smoothed.
    const std::vector<PassTime>& passes() const { return passes_; }

private:
    void smoothPasses(std::span<const gpu::PassSample> samples, uint32_t pictures);

    std::vector<PassTime> passes_;
};

} // namespace brume
