// The plan of a running scene: made anew when the scene, the settings or the viewers change, and under overload.
#pragma once

#include <chrono>
#include <span>

#include "server/plan/overload.h"
#include "server/plan/plan.h"
#include "server/sim/simulation.h"

namespace brume {

// The scene at the simulation's present state. Its cost grows with the particle count: about as that of an upload.
PlanScene planScene(const Scene& scene, const Simulation& simulation);

// What the scene's own camera sees, 640x360: for a plan without viewers.
PlanView ownView(const Scene& scene);

class Planner {
public:
    using Time = std::chrono::steady_clock::time_point;

    Planner(const Scene& scene, CostModel model, double frame_budget_ms);

    // What to render `views` with now. Plans when settings changed (`changed`) and when another number of views or sizes came;
    // else it costs nothing.
    const RenderSettings& settings(const Simulation& simulation, std::span<const PlanView> views, bool changed, Time now);
    // The same for the frames to come, every quarter of a second, since cameras and particles move: to be called while the device
    // works.
    void refresh(const Simulation& simulation, std::span<const PlanView> views, Time now);

    // Pixels between the rays of `view`, which may have moved since, with the settings of settings() or finer ones. 0: as they
    // say.
    uint32_t rateOf(const PlanView& view, const RenderSettings& settings) const;

    // A frame with these settings took so long. Logs when accuracy begins to be given up, when none is left to give up, and when
    // it is back.
    void took(double ms, Time now);
    void setFrameBudget(double ms) { overload_.setBudget(ms); }
    // PlanInputs::compiled, from the next plan on.
    void setCompiled(bool compiled) { inputs_.compiled = compiled; }

    // True: frames took too long with no accuracy left to give up, and have not been short enough since.
    bool exhausted() const { return exhausted_; }

    const Plan& plan() const { return plan_; }
    const CostModel& model() const { return model_; }
    const PlanInputs& inputs() const { return inputs_; } // of the plan

private:
    void renew(const Simulation& simulation, std::span<const PlanView> views, bool look, Time at); // `look`: at the scene, too
    void make();

    const Scene& scene_;
    CostModel model_;
    Overload overload_;
    PlanInputs inputs_;
    Plan plan_;
    bool exhausted_ = false;
    uint32_t worst_ = 0; // overload level since accuracy was whole
    Time overloaded_since_{};
    Time planned_{}, looked_{}; // when the plan was made; when the scene was looked at
};

} // namespace brume
