#include "server/plan/plan.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "server/medium/band_limit.h"
#include "server/methods/plans.h"

namespace brume {
namespace {

// What is in use stays while it is at most so much dearer, and its error so much larger, than what would be chosen
// anew: a camera on the edge between two ways does not change them every tick.
constexpr double kDearer = 1.25, kWorse = 1.1;
// Where nothing holds the budgets: the cheapest of those whose error is at most so many times the least that there is.
constexpr double kNearBest = 1.1;
// Overload trades error away up to so many times the budget.
constexpr double kMostRelaxed = 10;

// All combinations of what is left open, for the methods that `wanted_method` allows. `refused`: one line on a method
// that the scene does not allow.
std::vector<RenderSettings> waysOf(const PlanInputs& inputs, const std::string& wanted_method, std::string& refused) {
    std::vector<RenderSettings> ways;
    for (const MethodPlan* method : inputs.methods) {
        const bool asked = wanted_method == method->name();
        if (wanted_method != kAutoMethod && !asked) continue;
        RenderSettings way = inputs.scene.wanted;
        way.method = method->name();
        method->addWays(inputs.scene, way, asked, ways, refused);
    }
    return ways;
}

// Pixels of a deviation above which the coarsest rate is finer than needs be: other views would get too many rays by
// it.
constexpr double kMostDeviation = double(std::end(kRates)[-1]) / double(kRaysPerDeviation);

// True: views have their own rates, since nobody asked for one.
bool haveOwnRates(const PlanInputs& inputs, const RenderSettings& settings) {
    return planOf(settings.method)->hasRays() && inputs.scene.wanted.rate == 0;
}

bool sameWay(const RenderSettings& a, const RenderSettings& b) {
    const MethodSettings &own_of_a = a, &own_of_b = b;
    return a.method == b.method && a.rate == b.rate && a.slabs == b.slabs && a.shadow_error == b.shadow_error &&
           own_of_a == own_of_b;
}

// Costs and errors; what several ways have in common is counted once.
class Prices {
public:
    Prices(const PlanInputs& inputs, const CostModel& model) : inputs_(inputs), scene_(inputs.scene), model_(model) {
        for (const PlanView& view : inputs.views) {
            views_.emplace_back(scene_, view);
            inside_ = inside_ || (views_.back().inside() && views_.back().sees());
            if (!views_.back().sees()) continue;
            // The largest that has coarse enough rates; where all are larger, the smallest.
            const double own = views_.back().deviation();
            const bool fits = own <= kMostDeviation, had = deviation_ > 0 && deviation_ <= kMostDeviation;
            if (deviation_ == 0 || (fits ? !had || own > deviation_ : !had && own < deviation_)) deviation_ = own;
        }
        for (const PlanScene::Shadow& shadow : scene_.shadows)
            shadow_ms_.push_back(shadowWork(scene_, shadow).ms(model));
        allowed_.assign(views_.size(), double(scene_.wanted.error));
    }

    // Sets what every view may have, from the least error that any of these ways has in it.
    void setAllowed(const std::vector<RenderSettings>& ways) {
        double light = 1;
        for (const PlanScene::Shadow& shadow : scene_.shadows)
            if (shadow.wanted <= scene_.wanted.shadow_error)
                light = std::min(light, lightError(shadow.resolution.error));
        for (size_t i = 0; i < views_.size(); ++i) {
            double least = 1;
            for (const RenderSettings& way : ways) least = std::min(least, errorIn(views_[i], way).value_or(1));
            const double least_of_all = std::hypot(least, light);
            const double budget =
                std::min(double(scene_.wanted.error), errorOf(scene_.wanted.flip, views_[i].inside()));
            allowed_[i] = least_of_all <= budget ? budget : kNearBest * least_of_all;
        }
    }

    // From now on views get compiled rates.
    void setCompiledOnly() { compiled_only_ = true; }

    // Appends those of the settings' views that are not compiled, whatever setCompiledOnly() says.
    void addMissing(const RenderSettings& way, std::vector<RenderSettings>& missing) const {
        if (!inputs_.compiled) return;
        const auto add = [&](const RenderSettings& one) {
            const auto same = [&](const RenderSettings& other) { return sameWay(one, other); };
            if (!inputs_.compiled(one) && std::ranges::none_of(missing, same)) missing.push_back(one);
        };
        for (const ViewWork& view : views_) add(withOwnRate(view, way));
        if (views_.empty()) add(way);
    }

    // A candidate for each shadow map that the settings allow.
    void add(const RenderSettings& way, std::vector<Candidate>& all) {
        const Candidate bare = withoutShadow(way);
        for (size_t i = 0; i < scene_.shadows.size(); ++i)
            if (scene_.shadows[i].wanted <= scene_.wanted.shadow_error) all.push_back(with(bare, i));
    }
    Candidate of(const RenderSettings& settings) { return with(withoutShadow(settings), shadowOf(settings)); }

    // The way in use, if it is still one of `all`, with each view's rate as it is.
    std::optional<Candidate> before(const std::vector<Candidate>& all) {
        if (!inputs_.before) return {};
        const RenderSettings& before = *inputs_.before;
        const bool own_rates = inputs_.before_deviation_px > 0 && deviation_ > 0 && haveOwnRates(inputs_, before);
        const auto same = std::ranges::find_if(all, [&](const Candidate& c) {
            RenderSettings way = c.settings;
            if (own_rates) way.rate = before.rate;
            return sameWay(way, before);
        });
        if (same == all.end() || !own_rates) return same == all.end() ? std::nullopt : std::optional(*same);
        RenderSettings now = same->settings; // what the plan does not choose may have changed
        now.rate = before.rate;
        const double anew = std::exchange(deviation_, inputs_.before_deviation_px);
        const Candidate used = of(now);
        deviation_ = anew;
        return used;
    }
    // From now on rates are those of the view that PlanInputs::before was made for.
    void keepReference() {
        if (inputs_.before_deviation_px > 0 && deviation_ > 0) deviation_ = inputs_.before_deviation_px;
    }
    double deviation() const { return deviation_; }
    double lightErrorOf(const RenderSettings& settings) const {
        return lightError(scene_.shadows[shadowOf(settings)].resolution.error);
    }

    std::vector<PassCost> passes(const RenderSettings& settings) const {
        Work shared = sharedWork(scene_, settings), each;
        shared += shadowWork(scene_, scene_.shadows[shadowOf(settings)]);
        for (const ViewWork& view : views_) each += view.of(in(view, settings));
        std::vector<PassCost> all;
        for (const CostInfo* cost : allCosts()) {
            const double ms_per_unit = model_[*cost] * 1e-6;
            if (shared[*cost] > 0) all.push_back({cost->pass, true, shared[*cost] * ms_per_unit});
            if (each[*cost] > 0) all.push_back({cost->pass, false, each[*cost] * ms_per_unit});
        }
        return all;
    }

private:
    size_t shadowOf(const RenderSettings& settings) const {
        const auto same = [&](const PlanScene::Shadow& s) { return s.wanted == settings.shadow_error; };
        return size_t(std::find_if(scene_.shadows.begin(), std::prev(scene_.shadows.end()), same) -
                      scene_.shadows.begin());
    }
    RenderSettings withOwnRate(const ViewWork& view, RenderSettings way) const {
        if (haveOwnRates(inputs_, way) && deviation_ > 0) way.rate = rateFor(way.rate, view.deviation() / deviation_);
        return way;
    }
    // The way as it is drawn in that view.
    RenderSettings in(const ViewWork& view, const RenderSettings& way) const {
        RenderSettings own = withOwnRate(view, way);
        if (compiled_only_ && haveOwnRates(inputs_, way)) own.rate = nearestCompiledRate(own, inputs_.compiled);
        return own;
    }
    // Nothing: the method has no law of it.
    std::optional<double> errorIn(const ViewWork& view, const RenderSettings& way) const {
        const RenderSettings own = in(view, way);
        return view.sees() ? planOf(own.method)->error(own, view) : 0;
    }
    // errors_ are those of the last call.
    Candidate withoutShadow(const RenderSettings& way) {
        Candidate c{.settings = way, .shared_ms = sharedWork(scene_, way).ms(model_)};
        errors_.clear();
        for (const ViewWork& view : views_) {
            c.views_ms += view.of(in(view, way)).ms(model_);
            const std::optional<double> error = errorIn(view, way);
            c.predicted = c.predicted && error;
            errors_.push_back(error.value_or(1));
            c.error = std::max(c.error, errors_.back());
        }
        return c;
    }
    Candidate with(Candidate c, size_t shadow) const {
        c.settings.shadow_error = scene_.shadows[shadow].wanted;
        const double light = lightError(scene_.shadows[shadow].resolution.error);
        if (!c.predicted)
            c.error = c.flip = 1;
        else if (c.error > 0) // 0: nothing is seen
            c.error = std::hypot(c.error, light), c.flip = flipOf(c.error, inside_);
        for (size_t i = 0; i < errors_.size(); ++i)
            if (errors_[i] > 0)
                c.excess = std::max(c.excess, std::min(std::hypot(errors_[i], light), 1.0) / allowed_[i]);
        c.shared_ms += shadow_ms_[shadow];
        return c;
    }

    const PlanInputs& inputs_;
    const PlanScene& scene_; // of inputs_
    const CostModel& model_;
    std::vector<ViewWork> views_;
    bool inside_ = false; // True: some eye is in the medium
    bool compiled_only_ = false;
    double deviation_ = 0; // Plan::reference_deviation_px
    std::vector<double> shadow_ms_;
    std::vector<double> allowed_, errors_; // by view: what it may have; without the light's error
};

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
    return (asked ? "--method, --set render.method: " : file + ": render: ") + wrong;
}

std::vector<const MethodPlan*> allMethods() { return {methodPlans().begin(), methodPlans().end()}; }

// The map's estimate is a mean over views; some see up to 1.4 times as much of it.
double lightError(double estimated) { return 1.25 * estimated; }

// FLIP's definition for an error e of the luminance Y all over a picture: 0.0575 (38.7 Y^(1/3) e)^0.7, which is 0.56
// e^0.7 for Y = 0.3 and 0.7 e^0.7 for 0.8. From outside less of the medium is bright, and the error is in fewer places.
double flipOf(double error, bool inside) { return std::min((inside ? 0.65 : 0.5) * std::pow(error, 0.7), 1.0); }

double errorOf(double flip, bool inside) { return std::pow(flip / (inside ? 0.65 : 0.5), 1 / 0.7); }

std::optional<RenderSettings> relaxed(const RenderSettings& settings, uint32_t step, const Allowed& allowed) {
    const MethodPlan& method = *planOf(settings.method);
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
        std::string again;
        ways = waysOf(inputs, kAutoMethod, again);
    }
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
    plan.views = inputs.views.size();
    const auto less = [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); };
    plan.chosen = *std::ranges::min_element(all, less);
    prices.addMissing(plan.chosen.settings, plan.wanted);
    if (!plan.wanted.empty()) {
        std::vector<RenderSettings> compiled;
        std::ranges::copy_if(ways, std::back_inserter(compiled), inputs.compiled);
        if (!compiled.empty()) ways = std::move(compiled);
        prices.setCompiledOnly();
        price();
        plan.chosen = *std::ranges::min_element(all, less);
    }
    prices.setCompiledOnly();
    if (const auto used = prices.before(all)) {
        const bool fine_enough = used->excess <= kWorse * std::max(plan.chosen.excess, 1.0);
        const bool dear = used->ms() > kDearer * plan.chosen.ms();
        if (fine_enough && (!dear || inputs.hold)) {
            plan.kept = used->ms() > plan.chosen.ms();
            plan.held = dear;
            plan.chosen = *used;
            prices.keepReference();
        }
    }
    plan.base = plan.chosen.settings;
    plan.limit = limitOf(all, plan.chosen, wanted);
    while (plan.relaxed < inputs.relaxed) {
        const auto next = relaxed(plan.chosen.settings, plan.relaxed, [&](const RenderSettings& way) {
            if (inputs.compiled && !inputs.compiled(way)) {
                prices.addMissing(way, plan.wanted);
                return false;
            }
            const Candidate c = prices.of(way);
            return (c.predicted ? c.excess : prices.lightErrorOf(way) / double(wanted.error)) <= kMostRelaxed;
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

uint32_t nearestCompiledRate(RenderSettings way, const std::function<bool(const RenderSettings&)>& compiled) {
    const uint32_t wanted = way.rate;
    if (!compiled || wanted == 0) return wanted;
    for (way.rate = wanted; way.rate > 0; --way.rate)
        if (compiled(way)) return way.rate;
    for (way.rate = wanted + 1; way.rate <= std::end(kRates)[-1]; ++way.rate)
        if (compiled(way)) return way.rate;
    return wanted;
}

RenderSettings finer(const RenderSettings& settings) { return planOf(settings.method)->finer(settings); }

} // namespace brume
