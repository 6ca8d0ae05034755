// Planner: keeps the plan of a running scene, and makes it anew when scene, settings or viewers change and under
// overload.
#pragma once

#include <chrono>
#include <span>

#include "server/plan/cost_learning.h"
#include "server/plan/overload.h"
#include "server/plan/plan.h"
#include "server/plan/ready_ways.h"
#include "server/sim/simulation.h"

namespace brume {

// The scene at the simulation's present state, as the plan needs it. Its time grows with the particle count, about as
// an upload's.
// `lists`: only what shaders with these features draw is in it.
PlanScene planScene(const Scene& scene, const Simulation& simulation, const std::optional<SceneFeatures>& lists = {});

// The view of the scene's own camera, 640x360, for a plan without viewers.
PlanView ownView(const Scene& scene);

class Planner {
public:
    using Time = std::chrono::steady_clock::time_point;

    // `ways`: the plan takes those that are ready, and says what it wants. Null: every way may be used at once.
    Planner(const Scene& scene, CostModel model, double frame_budget_ms, ReadyWays* ways = nullptr);

    // The settings to render `views` with. Makes a new plan if settings changed (`changed`), or if a view is far from
    // all that the plan was made for; otherwise it costs nothing.
    const RenderSettings& settings(const Simulation& simulation, std::span<const PlanView> views, bool changed,
                                   Time now);
    // Makes a new plan for the coming frames every quarter of a second, since viewers, cameras and particles move. What
    // errs too much is replaced at once, what is too dear only after two seconds in which it always was. To be called
    // while the device works, so that no frame waits.
    void refresh(const Simulation& simulation, std::span<const PlanView> views, Time now);

    // The way to draw one picture within the scene's error budget, whatever the load. It depends on the scene's state,
    // the view and the costs alone, so that equal requests of one state give equal pictures.
    // It may not be compiled: see drawable(). `compiled`: true for the best of those that are, if there is one.
    Candidate once(const Simulation& simulation, const PlanView& view, bool compiled = false) const;

    // Pixels between rays for `view`, which may have moved since the plan was made. `settings`: those of settings(),
    // or finer ones. `still`: of a still picture. 0: use settings.rate.
    uint32_t rateOf(const PlanView& view, const RenderSettings& settings, bool still = false) const;

    // True: the shaders of these settings are compiled. If not, they are wanted from now on. Pictures of several hues
    // take those of full colour, as still ones do.
    bool drawable(const RenderSettings& settings, bool still) const;

    // brume::predictedError() in the scene of the last plan.
    double predictedError(const RenderSettings& settings, const PlanView& view) const {
        return inputs_.law_factor * brume::predictedError(inputs_.scene, settings, view);
    }
    // Makes all laws wrong on purpose, from the next plan on: PlanInputs::law_factor.
    void setLawFactor(double factor) { inputs_.law_factor = factor; }

    // What measuring says of the laws, from the next plan on.
    Corrections& corrections() { return corrections_; }

    // The passes of a picture or several took these times: corrects the costs of the next plans, but not of once().
    // `disturbed`: as of CostLearning::learn().
    void passesTook(const RenderSettings& settings, std::span<const PlanView> views, std::span<const uint32_t> rates,
                    std::span<const PassMs> passes, bool disturbed = false);
    const CostLearning& costs() const { return costs_; }

    // A frame with these settings took so long. Logs when accuracy begins to be given up, when none is left to give
    // up, and when it is back.
    void took(double ms, Time now);
    // From the next plan on: pictures show only what shaders with these features draw.
    void drawOnly(const SceneFeatures& lists) { lists_ = lists; }
    void setFrameBudget(double ms) { overload_.setBudget(ms); }

    // True: frames took too long with no accuracy left to give up, and have not been short enough since.
    bool exhausted() const { return exhausted_; }

    const Plan& plan() const { return plan_; }
    const PlanInputs& inputs() const { return inputs_; } // of the last plan

private:
    // `look`: true if the scene is measured, too. `patient`: PlanInputs::patient, for two seconds at most.
    void renew(const Simulation& simulation, std::span<const PlanView> views, bool look, bool patient, Time at);
    void make();
    void waitForShaders();
    void tellWaiting();
    RenderSettings asDrawn(const RenderSettings& asked) const;
    bool someoneJumped(std::span<const PlanView> views) const;

    const Scene& scene_;
    CostLearning costs_;
    ReadyWays* const ways_;
    std::optional<SceneFeatures> lists_; // nothing: all that there are
    Overload overload_;
    Corrections corrections_;
    std::vector<PlanView> views_; // that the plan was made for
    PlanInputs inputs_;           // of some of them
    Plan plan_;
    std::optional<RenderSettings> drawn_for_; // what was asked for first, or last when there was a compiled way for it
    bool exhausted_ = false;
    uint32_t worst_ = 0; // highest overload level since accuracy was last full
    Time overloaded_since_{};
    Time planned_{}, looked_{};       // when the plan was made; when the scene was measured
    uint64_t looked_tick_ = 0;        // the tick of the scene that was measured
    Time patient_since_{};            // since when every plan has been Plan::by_patience
    std::optional<Time> waits_since_; // since when every plan has waited for shaders: waitsFor()
    bool waits_told_ = false;         // True: the log says so
};

} // namespace brume
