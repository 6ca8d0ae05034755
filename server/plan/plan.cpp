#include "server/plan/plan.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "server/medium/band_limit.h"
#include "server/methods/plans.h"
#include "server/plan/prices.h"

namespace brume {
namespace {

// What is in use stays while it is at most so much dearer, and its error so much larger, than what would be chosen
// anew: a camera on the edge between two ways does not change them every tick.
constexpr double kDearer = 1.12, kWorse = 1.1;
// While shaders of what would be chosen are compiled, it stays with so much more error.
constexpr double kWorseMeanwhile = 1.5;
// Overload trades error away up to so many times the budget.
constexpr double kMostRelaxed = 10;
// Steps that the last plan took are kept up to so many times that: views come and go, and their errors differ.
constexpr double kKept = 1.5;
// A step that saves less of the time is not taken: the time is elsewhere. One that the last plan took stays with half.
constexpr double kLeastSaved = 0.02;

// All combinations of what is left open, for the methods that `wanted_method` allows. `refused`: one line on a method
// that the scene does not allow.
std::vector<RenderSettings> waysOf(const PlanInputs& inputs, const std::string& wanted_method, std::string& refused) {
    std::vector<RenderSettings> ways;
    for (const MethodPlan* method : inputs.methods) {
        const bool asked = wanted_method == method->name();
        if (wanted_method != kAutoMethod && !asked) continue;
        RenderSettings way = inputs.scene.wanted;
        way.method = method->name();
        if (const std::string why = extrasRefusal(*method, inputs.scene.features); !why.empty()) {
            if (asked) refused = why;
            continue;
        }
        if (const std::string why = mediumRefusal(*method, inputs.scene.features); !why.empty()) {
            if (asked) refused = why;
            continue;
        }
        if (const std::string why = scatteringRefusal(*method, way); !why.empty()) {
            if (asked) refused = why;
            continue;
        }
        method->addWays(inputs.scene, way, asked, ways, refused);
    }
    return ways;
}

// Smaller is better: whether it is outside the budgets, and then what counts there.
using Rank = std::tuple<int, double, double>;

// Why a way was not taken, all reasons in one line.
std::string whyNot(const Candidate& c, const Candidate& chosen, const RenderSettings& wanted) {
    std::string why;
    const auto add = [&](const std::string& reason) { why += (why.empty() ? "" : ", ") + reason; };
    if (!c.predicted) {
        if (wanted.error < 1) add("error not predicted");
    } else {
        if (c.error > double(wanted.error)) add(fmt::format("error above {:.3g} %", 100 * wanted.error));
        if (c.flip > double(wanted.flip)) add(fmt::format("FLIP above {:.3g}", wanted.flip));
    }
    if (c.ms() > chosen.ms()) add(fmt::format("{:.2f} times the time", c.ms() / chosen.ms()));
    return why.empty() ? "not clearly better than what is in use" : why;
}

// The best of each method and rate but the chosen one, with why it was not taken.
std::vector<Candidate> othersOf(const std::vector<Candidate>& all, const Candidate& chosen,
                                const RenderSettings& wanted, const std::function<Rank(const Candidate&)>& rank) {
    std::vector<Candidate> others;
    for (const Candidate& c : all) {
        RenderSettings otherwise = c.settings; // another shadow map alone is no other way
        otherwise.shadow_error = chosen.settings.shadow_error;
        if (sameWay(otherwise, chosen.settings)) continue;
        const auto alike = [&](const Candidate& o) {
            return o.settings.method == c.settings.method && o.settings.rate == c.settings.rate &&
                   planOf(c.settings.method)->variant(o.settings) == planOf(c.settings.method)->variant(c.settings);
        };
        const auto rival = std::find_if(others.begin(), others.end(), alike);
        if (rival == others.end()) {
            others.push_back(c);
            continue;
        }
        if (rank(c) < rank(*rival)) *rival = c;
    }
    for (Candidate& c : others) c.why_not = whyNot(c, chosen, wanted);
    return others;
}

// Which budget keeps `chosen` from being cheaper: the one without which a cheaper way holds.
Limit limitOf(const std::vector<Candidate>& all, const Candidate& chosen, const RenderSettings& wanted) {
    bool without_error = false, without_flip = false, without_both = false;
    for (const Candidate& c : all) {
        if (c.ms() >= chosen.ms() || !c.predicted) continue;
        const bool error = c.error <= double(wanted.error), flip = c.flip <= double(wanted.flip);
        without_error = without_error || flip, without_flip = without_flip || error, without_both = true;
    }
    if (without_error == without_flip) return without_both ? Limit::both : Limit::time;
    return without_error ? Limit::error : Limit::flip;
}

} // namespace

std::string checkWanted(const RenderSettings& wanted) {
    RenderSettings named = wanted;
    if (wanted.method == kAutoMethod) named.method = methodPlans().front()->name();
    std::string wrong = checkSettings(named);
    if (const size_t at = wrong.find("there are: "); at != wrong.npos && wrong.starts_with("no method"))
        wrong.insert(at + 11, std::string(kAutoMethod) + ", ");
    return wrong;
}

std::string checkWanted(const RenderSettings& wanted, const std::string& file, std::span<const std::string> overrides) {
    const std::string wrong = checkWanted(wanted);
    if (wrong.empty()) return {};
    const bool asked =
        std::ranges::any_of(overrides, [](std::string_view one) { return one.starts_with("render.method"); });
    const bool unknown = wanted.method != kAutoMethod && !planOf(wanted.method);
    return (asked ? "--method, --set render.method: " : file + (unknown ? ": render.method: " : ": render: ")) + wrong;
}

std::vector<const MethodPlan*> allMethods() { return {methodPlans().begin(), methodPlans().end()}; }

// The map's estimate is a mean over views; some see up to 1.4 times as much of it.
double lightError(double estimated) { return 1.25 * estimated; }

// FLIP's definition for an error e of the luminance Y all over a picture: 0.0575 (38.7 Y^(1/3) e)^0.7, which is 0.56
// e^0.7 for Y = 0.3 and 0.7 e^0.7 for 0.8. From outside less of the medium is bright, and the error is in fewer places.
static double flipFactor(bool inside, bool measured) { return measured ? (inside ? 0.5 : 0.4) : (inside ? 0.65 : 0.5); }

double flipOf(double error, bool inside, bool measured) {
    return std::min(flipFactor(inside, measured) * std::pow(error, 0.7), 1.0);
}

double errorOf(double flip, bool inside, bool measured) {
    return std::pow(flip / flipFactor(inside, measured), 1 / 0.7);
}

std::optional<RenderSettings> relaxed(const RenderSettings& settings, uint32_t step, const Allowed& allowed) {
    const MethodPlan& method = *planOf(settings.method);
    std::optional<RenderSettings> softer = settings;
    while ((softer = method.coarser(*softer, Coarser::light)))
        if (!allowed || allowed(*softer)) return softer;
    for (uint32_t tries = 0; tries < 3; ++tries) {
        std::optional<RenderSettings> next;
        const uint32_t what = (step + tries) % 3;
        if (what < 2) {
            next = method.coarser(settings, what == 0 ? Coarser::along : Coarser::across);
        } else if (2 * settings.shadow_error <= kCoarsestShadow) {
            next = settings;
            next->shadow_error *= 2;
        }
        if (next && (!allowed || allowed(*next))) return next;
    }
    return {};
}

Plan makePlan(const PlanInputs& inputs, const CostModel& model) {
    const RenderSettings& wanted = inputs.scene.wanted;
    Prices prices(inputs, model);
    std::vector<Candidate> all;
    Plan plan;
    std::vector<RenderSettings> ways = waysOf(inputs, wanted.method, plan.refused);
    if (ways.empty()) {
        std::string also;
        ways = waysOf(inputs, kAutoMethod, also);
    }
    if (ways.empty()) throw std::runtime_error(plan.refused.empty() ? "no method draws this scene" : plan.refused);
    const auto price = [&] {
        all.clear();
        prices.setAllowed(ways);
        for (const RenderSettings& way : ways) prices.add(way, all);
    };
    price();

    const auto holds = [&](const Candidate& c) {
        return c.error <= double(wanted.error) && c.flip <= double(wanted.flip);
    };
    const auto rank = [](const Candidate& c) -> Rank {
        return c.excess <= 1 ? Rank{0, c.ms(), c.error} : Rank{1, c.excess, c.ms()};
    };
    plan.views = std::max(inputs.pictures, inputs.views.size());
    const auto less = [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); };
    plan.chosen = *std::ranges::min_element(all, less);
    prices.addMissing(plan.chosen.settings, plan.missing);
    if (!plan.missing.empty()) {
        std::vector<RenderSettings> compiled;
        std::ranges::copy_if(ways, std::back_inserter(compiled), inputs.compiled);
        if (!compiled.empty()) ways = std::move(compiled);
        prices.setCompiledOnly();
        price();
        plan.chosen = *std::ranges::min_element(all, less);
    }
    prices.setCompiledOnly();
    if (const auto used = prices.before(all)) {
        const double worse = plan.missing.empty() ? kWorse : kWorseMeanwhile;
        const bool fine_enough = used->excess <= worse * std::max(plan.chosen.excess, 1.0);
        const bool dear = used->ms() > kDearer * plan.chosen.ms();
        if (fine_enough && (!dear || inputs.patient)) {
            plan.kept = used->ms() > plan.chosen.ms();
            plan.by_patience = dear;
            plan.chosen = *used;
            prices.keepReference();
        }
    }
    plan.base = plan.chosen.settings;
    plan.limit = limitOf(all, plan.chosen, wanted);
    while (plan.relaxed < inputs.relaxed) {
        const auto next = relaxed(plan.chosen.settings, plan.relaxed, [&](const RenderSettings& way) {
            const Candidate c = prices.of(way);
            const bool taken = plan.relaxed < inputs.relaxed_before;
            const double kept = taken ? kKept : 1, least = taken ? kLeastSaved / 2 : kLeastSaved;
            if (c.predicted && plan.chosen.ms() - c.ms() < least * plan.chosen.ms()) return false;
            if (inputs.compiled && !inputs.compiled(way)) {
                prices.addMissing(way, plan.missing);
                return false;
            }
            return (c.predicted ? c.excess : prices.lightErrorOf(way) / double(wanted.error)) <= kept * kMostRelaxed;
        });
        if (!next) break;
        plan.less_relaxed_ms = plan.chosen.ms();
        plan.chosen = prices.of(*next);
        ++plan.relaxed;
    }
    plan.reference_deviation_px = haveOwnRates(inputs, plan.chosen.settings) ? prices.deviation() : 0;
    plan.within = holds(plan.chosen);
    plan.still_ms = prices.of(finer(plan.chosen.settings)).ms();
    plan.passes = prices.passes(plan.chosen.settings);
    plan.others = othersOf(all, plan.chosen, wanted, rank);
    return plan;
}

RenderSettings finer(const RenderSettings& settings) { return planOf(settings.method)->finer(settings); }

} // namespace brume
