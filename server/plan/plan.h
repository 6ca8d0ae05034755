// What to render with: of all ways, the cheapest whose predicted error is within the budget. A pure function of the scene, the
// viewers and what the device's work costs.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/plan/cost_model.h"
#include "server/plan/work.h"

namespace brume {

// The method's name that leaves the choice to the plan.
inline constexpr const char* kAutoMethod = "auto";

// As checkSettings() of server/render/method.h, with "auto" allowed.
std::string checkWanted(const RenderSettings& wanted);

struct PlanInputs {
    PlanScene scene;
    std::vector<PlanView> views;          // with none: as if the scene's camera looked
    std::vector<std::string> methods;     // that there are
    uint32_t relaxed = 0;                 // steps of relaxed(), under overload
    std::optional<RenderSettings> before; // Plan::base in use: kept unless another way is clearly better
    // Whether shaders of all rates are: CPU drivers take seconds for one that makes edges of objects. Until then all views of a
    // scene with objects have one rate.
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
    bool within = true;   // the budget holds; else the cheapest of the most accurate ways was taken
    bool kept = false;    // as before, though another way is a little cheaper
    RenderSettings base;  // before overload
    uint32_t relaxed = 0; // steps that overload took, of those asked for: its error ends at ten times the budget
    double finer_ms = 0;  // what one step less would take
    double rests_ms = 0;  // what chosen would with finer()
    // Pixels that the medium's has in the view whose rate is settings.rate; others have their own, by rateFor(). 0: all have that
    // one, or no view sees the medium.
    double deviation = 0;
};

// `wanted.method` and settings other than 0 are kept whatever they cost: the plan only chooses what is left open. A method that
// the scene does not allow is not: then all others are open.
Plan makePlan(const PlanInputs& inputs, const CostModel& model);

// Errors that approximations leave (relative RMSE), as measured against the double-precision reference: docs/results/plan.md.
// `inside`: the eye is in the medium.
// Of rays, in projected standard deviations.
double rayError(double spacing);
// Of slabs, in standard deviations; `depth`: mean optical depth of one.
double slabError(double thickness, double depth, bool inside);
// Of the grid's nodes, in standard deviations.
double gridError(double spacing);
// Of the light's map, by its own estimate for the light in the medium.
double lightError(double estimated);
// What remains of a method however fine the rest is.
double methodError(const RenderSettings& settings, bool inside);
// Mean FLIP of pictures with such an error.
double flipOf(double error, bool inside);

// Pixels between rays in a view where the medium's deviation has `part` of the pixels that it has where they are `rate`: rays as
// far apart in deviations, up to 15 % farther. Views keep theirs while cameras move a little.
uint32_t rateFor(uint32_t rate, double part);

// The next coarser settings, in the order in which overload gives up accuracy: slabs, rays, shadow volume, and again; what is at
// its end, or not `allowed`, is passed over. Empty when all are. `step` counts from 0.
using Allowed = std::function<bool(const RenderSettings&)>;
std::optional<RenderSettings> relaxed(const RenderSettings& settings, uint32_t step, const Allowed& allowed = {});

// The plan for people: each choice with its cost and error, then what was not taken and why.
std::string explain(const Plan& plan, const PlanInputs& inputs, const CostModel& model);
// In one line, for a log.
std::string summary(const Plan& plan);
// A way, in a few words.
std::string wayText(const RenderSettings& settings);

// The same with half as far between rays and slabs, for pictures that rest.
RenderSettings finer(RenderSettings settings);

} // namespace brume
