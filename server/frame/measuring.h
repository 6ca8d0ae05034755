// Measuring: what a server learns of its own pictures while it runs. Some of their pixels are read back and traced
// exactly, and what passes took corrects their costs.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "common/other_work.h"
#include "server/compile/compiled_ways.h"
#include "server/error/error_meter.h"
#include "server/frame/batch.h"
#include "server/frame/frame_options.h"
#include "server/frame/shown_scene.h"
#include "server/loop/promise_watch.h"
#include "server/plan/planner.h"

namespace brume {

class Measuring {
public:
    // Both outlive it.
    Measuring(const ShownScene& shown, const gpu::Device& device, const FrameOptions& options);

    // Before a batch of moving or still pictures is drawn: chooses pixels to read back with it, if it is time; shows
    // what is known to those who look at their error; and says it to all.
    void before(Batch& batch, const Planner& planner, const CompiledWays& ways);
    // After it was drawn, or was not: takes those pixels.
    void after(Batch& batch, bool drawn);
    // A job for one of the viewers who draw by themselves, if it is time; otherwise null.
    struct Drawer {
        uint32_t viewer;
        const PoseRequest* request;
    };
    std::unique_ptr<MeterJob> beginLit(std::span<const Drawer> drawers, Clock::time_point now);
    // Takes it with what they draw, on any thread. Null: the message was not made.
    void giveLit(std::unique_ptr<MeterJob> job, std::shared_ptr<const lit::Medium> medium);
    // What is known of a viewer's pictures by this method; all 0: nothing.
    MeasuredError known(uint32_t viewer, const std::string& method) const;
    // What is known of all who draw by themselves: the root of their mean square. 0: nothing.
    float knownOfDrawers() const;
    // The times of a batch's passes, one by one: corrects the planner's costs by them from time to time.
    void learnCosts(const Batch& batch, std::span<const gpu::PassSample> samples, Planner& planner);
    // What was measured since the last call, to be called ten times a second: the planner hears it, and the log when a
    // promise is broken. `viewers`: ids, ascending; others are forgotten.
    void read(std::span<const uint32_t> viewers, Planner& planner, Clock::time_point now);
    // Another scene.
    void forget();

    std::span<const ViewError> errors() const { return errors_; } // of the last read()

private:
    bool fill(MeterJob& job, const Pose& pose, glm::uvec2 size) const;
    void choose(Batch& batch, const Planner& planner, const CompiledWays& ways);
    void show(Batch& batch);
    void tell(Batch& batch) const;
    DrawnWith drawnWith(const RenderSettings& settings, const EyeRequest& eye) const;

    const ShownScene& shown_;
    const gpu::Device& device_;
    ErrorMeter meter_;
    const bool learns_costs_;
    const std::function<void(const CostModel&)> on_costs_;
    const std::function<void(uint64_t, std::span<const ViewError>, const Plan&)> on_errors_;
    OtherWork other_work_;
    Clock::time_point costs_learnt_{}, costs_told_{};
    std::vector<uint32_t> drawn_viewers_;      // viewers of a batch whose pictures are drawn
    std::vector<gpu::ErrorDisc> shown_errors_; // of the batch's eyes that look at them
    std::vector<ViewError> errors_;
    PromiseWatch promise_;
};

} // namespace brume
