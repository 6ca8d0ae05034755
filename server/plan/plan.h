// The plan: chooses, of all ways to render, the cheapest whose predicted error is within the scene's error budget. A
// pure function of the scene, the views, the methods and the cost model.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/plan/corrections.h"
#include "server/plan/method_plan.h"

namespace brume {

// Method name in a scene that leaves the choice to the plan.
inline constexpr const char* kAutoMethod = "auto";

// checkSettings() (server/methods/plans.h) that also allows "auto".
std::string checkWanted(const RenderSettings& wanted);
// The same with its source: the scene's file, or the option if an override of it (loadScene()) names the method.
std::string checkWanted(const RenderSettings& wanted, const std::string& file, std::span<const std::string> overrides);

struct PlanInputs {
    PlanScene scene;
    std::vector<PlanView> views;            // the views to plan for; empty: the scene's own camera
    size_t pictures = 0;                    // that they stand for; 0: themselves alone
    std::vector<const MethodPlan*> methods; // methods to choose from, usually allMethods()
    uint32_t relaxed = 0;                   // overload level: how often relaxed() is applied
    uint32_t relaxed_before = 0;            // Plan::relaxed of the last plan
    std::optional<RenderSettings> before;   // the present Plan::base: kept unless another way is clearly better
    double before_deviation_px = 0;         // the present Plan::reference_deviation_px
    bool patient = false; // True: `before` is kept also where another way is much cheaper, if its error is small enough
    const Corrections* corrections = nullptr; // of the laws' errors, by PlanView::viewer; null: none
    double law_factor = 1;                    // on the error of every law: not 1 where laws are wrong on purpose
    // True: the shaders of these settings are compiled. As long as one way is, others are not chosen. Null: all are.
    std::function<bool(const RenderSettings&)> compiled;
};

// One way to render, with its predicted cost and error.
struct Candidate {
    RenderSettings settings; // no setting is left open
    double error = 0;        // relative RMSE of the worst view; 1, that of a black picture, if it is not predicted
    double flip = 0;         // mean FLIP that belongs to the error; 1 if that is not predicted
    bool predicted = true;   // False: the method has no law of its error
    // The largest, over views, of a view's error by the error that it may have; at most 1: the way will do. A view may
    // have the budgets. Where no way keeps them, it may have 1.03 times the least error of any way (kNearBest), so that
    // it does not make other views coarse. An error without a law makes it infinite, or 1 where any error is allowed.
    double excess = 0;
    double shared_ms = 0; // per tick
    double views_ms = 0;  // of all views together
    std::string why_not;  // reason, one line; empty: this is the plan

    double ms() const { return shared_ms + views_ms; }
};

// What keeps the plan from a cheaper way.
enum class Limit : uint8_t {
    time,
    error,
    flip,
    both
}; // time: it is the cheapest of all ways; both: each budget alone would do

// The plans of all methods (methodPlans()), for PlanInputs.
std::vector<const MethodPlan*> allMethods();

// Predicted cost of one pass.
struct PassCost {
    const char* pass;
    bool shared; // True: once per tick for all views
    double ms;   // of all views together
};

struct Plan {
    Candidate chosen;
    std::vector<PassCost> passes;        // of the frame
    std::vector<Candidate> others;       // the best way of each method and rate that was not chosen
    size_t views = 1;                    // that are drawn
    std::vector<RenderSettings> missing; // ways that would have been taken if they were ready, with the views' rates
    std::string refused;                 // "METHOD: reason" for a method that the scene does not allow; empty: none
    bool within = true;        // True: the error budget holds; false: the cheapest of the most accurate ways was taken
    bool kept = false;         // True: PlanInputs::before was kept, though another way is a little cheaper
    bool by_patience = false;  // True: it would not have been without PlanInputs::patient
    Limit limit = Limit::time; // before overload
    RenderSettings base;       // the settings before overload
    // Overload steps taken, of those asked for. They end at ten times the error budget, and at 15 times if the last
    // plan took them. A step is passed over if it saves less than 2 % of the time, or 1 % if the last plan took it.
    uint32_t relaxed = 0;
    double less_relaxed_ms = 0; // predicted time one overload step earlier
    double still_ms = 0;        // predicted time with finer(), for still pictures
    // The medium's standard deviation, in pixels, in the view that settings.rate fits; other views have rates of
    // their own, by rateFor(). 0: all have one rate, or no view sees the medium.
    double reference_deviation_px = 0;
};

// Makes the plan. It keeps `wanted.method` and all settings other than 0, whatever they cost, and chooses the rest. A
// wanted method that the scene does not allow is replaced by the best other one.
Plan makePlan(const PlanInputs& inputs, const CostModel& model);

// Relative RMSE that the laws predict for one picture with these settings, whose rate is the view's own. 0: nothing is
// predicted, or no medium is seen.
double predictedError(const PlanScene& scene, const RenderSettings& settings, const PlanView& view);

// Relative RMSE of pictures, from the volumetric shadow map's estimate of its own error in the medium.
double lightError(double estimated);
// Mean FLIP of pictures with this relative RMSE. `inside`: true if the eye is in the medium. `measured`: true if
// pictures show that error; one that only laws say may be larger, and gets a margin.
double flipOf(double error, bool inside, bool measured);
double errorOf(double flip, bool inside, bool measured); // its inverse

// The next coarser settings under overload: first light that is sharp at pixels. Then `step`, from 0, selects a kind in
// turn: along rays, across rays, shadow map. A kind that cannot become coarser, or whose settings are not `allowed`, is
// passed over. Nothing if no kind is left.
using Allowed = std::function<bool(const RenderSettings&)>;
std::optional<RenderSettings> relaxed(const RenderSettings& settings, uint32_t step, const Allowed& allowed = {});

// The plan as text for people: the view that it is made for, what limits it, each choice with its cost and error, then
// the other ways and why they were not chosen.
std::string explain(const Plan& plan, const PlanInputs& inputs, const CostModel& model);
// The plan in one line, for a log.
std::string summary(const Plan& plan);
// Settings in a few words, for people.
std::string wayText(const RenderSettings& settings);
// The method that pictures are drawn by once its shaders are compiled, while the plan does not keep the error budget.
// Empty: nothing is waited for.
std::string waitsFor(const Plan& plan);

// The rate nearest to the way's own that is compiled, finer ones first; the way's own if none is.
uint32_t nearestCompiledRate(RenderSettings way, const std::function<bool(const RenderSettings&)>& compiled);

// Settings with a fraction of the error, for still pictures: MethodPlan::finer().
RenderSettings finer(const RenderSettings& settings);

} // namespace brume
