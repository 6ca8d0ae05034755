// What to render with: of all ways, the cheapest whose predicted error is within the budget. A pure function of the scene, the
// viewers, the methods and the costs of the device's work.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/plan/method_plan.h"

namespace brume {

// The method's name that leaves the choice to the plan.
inline constexpr const char* kAutoMethod = "auto";

// As checkSettings() (server/methods/plans.h), with "auto" allowed.
std::string checkWanted(const RenderSettings& wanted);

struct PlanInputs {
    PlanScene scene;
    std::vector<PlanView> views;            // with none: as if the scene's camera looked
    std::vector<const MethodPlan*> methods; // that there are; see allMethods()
    uint32_t relaxed = 0;                   // steps of relaxed(), under overload
    std::optional<RenderSettings> before;   // Plan::base in use: kept unless another way is clearly better
    // True: shaders of all rates are compiled. CPU drivers take seconds for one that draws the edges of objects; until then all
    // views of a scene with objects have one rate.
    bool compiled = true;
};

// One way to render, predicted.
struct Candidate {
    RenderSettings settings; // method, rate, slabs, shadow_error and so on, all resolved
    double error = 0;        // relative RMSE of the worst view
    double flip = 0;         // mean FLIP that comes with it
    double shared_ms = 0;    // per tick
    double views_ms = 0;     // of all views together
    std::string why_not;     // empty: the plan

    double ms() const { return shared_ms + views_ms; }
};

// methodPlans() as PlanInputs takes them.
std::vector<const MethodPlan*> allMethods();

struct PassCost {
    const char* pass;
    bool shared;
    double ms; // of all views together
};

struct Plan {
    Candidate chosen;
    std::vector<PassCost> passes;  // that the frame has
    std::vector<Candidate> others; // the best of each method and rate that was not taken
    size_t views = 1;
    std::string refused;  // "grid: why": a method that the scene does not allow; it was not among the ways
    bool within = true;   // True: the budget holds; false: the cheapest of the most accurate ways was taken
    bool kept = false;    // True: as before, though another way is a little cheaper
    RenderSettings base;  // before overload
    uint32_t relaxed = 0; // steps that overload took, of those asked for: its error ends at ten times the budget
    double finer_ms = 0;  // predicted time one overload step earlier
    double still_ms = 0;  // predicted time with finer(), for still pictures
    // The medium's standard deviation, in pixels, in the view that settings.rate fits; other views have rates of their own, by
    // rateFor(). 0: all have one rate, or no view sees the medium.
    double reference_deviation_px = 0;
};

// `wanted.method` and settings other than 0 are kept whatever they cost: the plan only chooses what is left open. A method that
// the scene does not allow is not: then all others are open.
Plan makePlan(const PlanInputs& inputs, const CostModel& model);

// Relative RMSE of pictures for the light's map's own estimate of its error in the medium.
double lightError(double estimated);
// Mean FLIP of pictures with a relative RMSE. `inside`: the eye is in the medium.
double flipOf(double error, bool inside);

// The next coarser settings, in the order in which overload gives up accuracy: along rays, across them, the shadow volume, and
// again. A kind that is at its end, or not `allowed`, is passed over. Empty when all are. `step` counts from 0.
using Allowed = std::function<bool(const RenderSettings&)>;
std::optional<RenderSettings> relaxed(const RenderSettings& settings, uint32_t step, const Allowed& allowed = {});

// The plan for people: each choice with its cost and error, then what was not taken and why.
std::string explain(const Plan& plan, const PlanInputs& inputs, const CostModel& model);
// In one line, for a log.
std::string summary(const Plan& plan);
// A way in a few words.
std::string wayText(const RenderSettings& settings);

// With a fraction of the error, for pictures that rest: MethodPlan::finer().
RenderSettings finer(const RenderSettings& settings);

} // namespace brume
