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

// The names of all methods of server/render/methods.cpp.
std::vector<std::string> methodNames();

// What the scene's own camera sees, 640x360: for a plan without viewers.
PlanView ownView(const Scene& scene);

class Planner {
public:
    using Time = std::chrono::steady_clock::time_point;

    Planner(const Scene& scene, CostModel model, double frame_budget_ms);

    // What to render `views` with now. Plans when settings changed (`changed`), another number of views or sizes came, overload
    // began or ended, and every quarter of a second, since cameras and particles move; else it costs nothing.
    const RenderSettings& settings(const Simulation& simulation, std::span<const PlanView> views, bool changed, Time now);

    // A frame with these settings took so long. Says each change in the log.
    void took(double ms, Time now);

    const Plan& plan() const { return plan_; }
    const CostModel& model() const { return model_; }
    const PlanInputs& inputs() const { return inputs_; } // of the plan

private:
    void make();

    const Scene& scene_;
    CostModel model_;
    Overload overload_;
    PlanInputs inputs_;
    Plan plan_;
    Time planned_{}, looked_{}; // when the plan was made; when the scene was looked at
    bool stale_ = true;
};

} // namespace brume
