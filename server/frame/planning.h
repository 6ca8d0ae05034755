// Planning: when the plan of the scene that is shown is made anew, and what lists of things may cost.
#pragma once

#include <optional>
#include <span>

#include "server/frame/frame_options.h"
#include "server/frame/shown_scene.h"
#include "server/plan/planner.h"
#include "server/viewer/audience.h"

namespace brume {

class Planning {
public:
    using Time = std::chrono::steady_clock::time_point;

    // Both outlive it.
    Planning(ShownScene& shown, ReadyWays& ways, const FrameOptions& options);

    Planner& planner() { return *planner_; }
    const Planner& planner() const { return *planner_; }

    // The next pictures have a new plan.
    void renew() { renew_ = true; }
    // Commands changed something that a plan depends on. Who moves a slider asks for a plan with each step: plans take
    // a part of the time, and what comes meanwhile is in the next one.
    void commandsCame() { asked_ = true; }
    // The settings for pictures of these views.
    const RenderSettings& settings(std::span<const PlanView> views, Time now);
    // True: the last pictures were drawn before the plan that commands asked for, and it may be made now.
    bool isLate(Time now) const { return drawn_before_ && now >= next_asked_; }

    // Another scene is shown: nothing is planned yet.
    void showScene(double frame_ms);
    // Says what another light or object would cost, after lists have changed.
    void priceLists(CommandQueue& commands);

private:
    ShownScene& shown_;
    ReadyWays& ways_;
    const CostModel costs_;
    const double most_frame_ms_;
    std::optional<Planner> planner_;
    bool renew_ = false;             // True: the last plan is of another scene, or of other features
    bool asked_ = false;             // True: commands changed something since the last plan
    bool drawn_before_ = false;      // True: the last pictures were drawn before the plan that commands asked for
    Time next_asked_{};              // no plan is made before only because of commands
    std::optional<uint64_t> priced_; // Simulation::listsHash() for which lights were priced; nothing: none was
    double list_ms_ = 0;             // time that a picture may take with all lists; 0: not known yet
};

} // namespace brume
