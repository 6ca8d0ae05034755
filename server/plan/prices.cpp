#include "server/plan/prices.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "server/effects/shadow_volume/shadow_volume_plan.h"
#include "server/medium/band_limit.h"
#include "server/methods/plans.h"

namespace brume {
namespace {

// Where nothing holds the budgets: the cheapest of those whose error is at most so many times the least that there is.
constexpr double kNearBest = 1.03;
// Laws grow without end, errors do not: a picture that shows nothing of the medium errs by 1.
constexpr double kMostLight = 1; // so that a law beyond its use does not hide how coarse rays and slabs are
double bounded(double law) { return 1 - 1 / (1 + law); }

// Pixels of a deviation above which the coarsest rate is finer than needs be: other views would get too many rays by
// it.
constexpr double kMostDeviation = double(std::end(kRates)[-1]) / double(kRaysPerDeviation);

} // namespace

bool haveOwnRates(const PlanInputs& inputs, const RenderSettings& settings) {
    return planOf(settings.method)->hasRays() && inputs.scene.wanted.rate == 0;
}

bool sameWay(const RenderSettings& a, const RenderSettings& b) {
    const MethodSettings &own_of_a = a, &own_of_b = b;
    return a.method == b.method && a.rate == b.rate && a.slabs == b.slabs && a.shadow_error == b.shadow_error &&
           a.lamp_spacing == b.lamp_spacing && a.soft_edges == b.soft_edges && own_of_a == own_of_b;
}

Prices::Prices(const PlanInputs& inputs, const CostModel& model)
    : inputs_(inputs), scene_(inputs.scene), model_(model) {
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
        shadow_ms_.push_back(scene_.renewed * shadowWork(scene_, shadow).ms(model));
    allowed_.assign(views_.size(), 1);
}

void Prices::setAllowed(const std::vector<RenderSettings>& ways) {
    double light = HUGE_VAL;
    for (const PlanScene::Shadow& shadow : scene_.shadows)
        if (shadow.wanted <= scene_.wanted.shadow_error) light = std::min(light, lightError(shadow.resolution.error));
    for (size_t i = 0; i < views_.size(); ++i) {
        double least_of_all = HUGE_VAL; // budgets
        for (const RenderSettings& way : ways) {
            const double error = corrected(i, way, errorIn(views_[i], way).value_or(HUGE_VAL), light);
            least_of_all = std::min(least_of_all, error / budgetOf(i, way));
        }
        allowed_[i] = least_of_all <= 1 ? 1 : kNearBest * least_of_all;
    }
}

void Prices::addMissing(const RenderSettings& way, std::vector<RenderSettings>& missing) const {
    if (!inputs_.compiled) return;
    const auto add = [&](const RenderSettings& one) {
        const auto same = [&](const RenderSettings& other) { return sameWay(one, other); };
        if (!inputs_.compiled(one) && std::ranges::none_of(missing, same)) missing.push_back(one);
    };
    for (const ViewWork& view : views_) add(withOwnRate(view, way));
    if (views_.empty()) add(way);
}

void Prices::add(const RenderSettings& way, std::vector<Candidate>& all) {
    const Candidate bare = withoutShadow(way);
    for (size_t i = 0; i < scene_.shadows.size(); ++i)
        if (scene_.shadows[i].wanted <= scene_.wanted.shadow_error) all.push_back(with(bare, i));
}

std::optional<Candidate> Prices::before(const std::vector<Candidate>& all) {
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
    // Each view's rate is as it was chosen then.
    const double reference = std::exchange(deviation_, inputs_.before_deviation_px);
    const Candidate used = of(now);
    deviation_ = reference;
    return used;
}

std::vector<PassCost> Prices::passes(const RenderSettings& settings) const {
    Work shared = sharedWork(scene_, settings), each;
    shared += shadowWork(scene_, scene_.shadows[shadowOf(settings)]);
    for (size_t i = 0; i < views_.size(); ++i) {
        Work of_view = views_[i].of(in(views_[i], settings));
        each += of_view *= inputs_.views[i].weight;
    }
    std::vector<PassCost> all;
    for (const CostInfo* cost : allCosts()) {
        const double ms_per_unit = model_[*cost] * 1e-6;
        if (shared[*cost] > 0) all.push_back({cost->pass, true, scene_.renewed * shared[*cost] * ms_per_unit});
        if (each[*cost] > 0) all.push_back({cost->pass, false, each[*cost] * ms_per_unit});
    }
    return all;
}

size_t Prices::shadowOf(const RenderSettings& settings) const {
    const auto same = [&](const PlanScene::Shadow& s) { return s.wanted == settings.shadow_error; };
    return size_t(std::find_if(scene_.shadows.begin(), std::prev(scene_.shadows.end()), same) - scene_.shadows.begin());
}

RenderSettings Prices::withOwnRate(const ViewWork& view, RenderSettings way) const {
    if (haveOwnRates(inputs_, way) && deviation_ > 0) way.rate = rateFor(way.rate, view.deviation() / deviation_);
    return way;
}

RenderSettings Prices::in(const ViewWork& view, const RenderSettings& way) const {
    RenderSettings own = withOwnRate(view, way);
    if (compiled_only_ && haveOwnRates(inputs_, way)) own.rate = nearestCompiledRate(own, inputs_.compiled);
    return own;
}

std::optional<double> Prices::errorIn(const ViewWork& view, const RenderSettings& way) const {
    const RenderSettings own = in(view, way);
    return view.errs() ? planOf(own.method)->error(own, view) : 0;
}

double Prices::corrected(size_t i, const RenderSettings& way, double rays, double light) const {
    const double law =
        inputs_.law_factor * std::hypot(rays, std::min(views_[i].light().lightFactor() * light, kMostLight));
    return inputs_.corrections ? law * inputs_.corrections->factor(inputs_.views[i].viewer, way.method, law) : law;
}

bool Prices::isMeasured(size_t i, const RenderSettings& way) const {
    return inputs_.corrections && inputs_.corrections->knows(inputs_.views[i].viewer, way.method);
}

double Prices::budgetOf(size_t i, const RenderSettings& way) const {
    return std::min(double(scene_.wanted.error), errorOf(scene_.wanted.flip, views_[i].inside(), isMeasured(i, way)));
}

Candidate Prices::withoutShadow(const RenderSettings& way) {
    Candidate c{.settings = way, .shared_ms = scene_.renewed * sharedWork(scene_, way).ms(model_)};
    errors_.clear();
    for (size_t i = 0; i < views_.size(); ++i) {
        const ViewWork& view = views_[i];
        c.views_ms += inputs_.views[i].weight * view.of(in(view, way)).ms(model_);
        const std::optional<double> error = errorIn(view, way);
        c.predicted = c.predicted && error;
        errors_.push_back(error.value_or(HUGE_VAL));
    }
    return c;
}

Candidate Prices::with(Candidate c, size_t shadow) const {
    c.settings.shadow_error = scene_.shadows[shadow].wanted;
    const double light = lightError(scene_.shadows[shadow].resolution.error);
    for (size_t i = 0; i < errors_.size() && c.predicted; ++i) {
        if (errors_[i] <= 0) continue; // nothing is seen
        const double error = corrected(i, c.settings, errors_[i], light);
        c.error = std::max(c.error, bounded(error));
        c.excess = std::max(c.excess, error / budgetOf(i, c.settings) / allowed_[i]);
        c.flip = std::max(c.flip, flipOf(bounded(error), inside_, isMeasured(i, c.settings)));
    }
    if (!c.predicted)
        c.error = c.flip = 1, c.excess = scene_.wanted.error >= 1 ? 1 : HUGE_VAL; // 1: any error is allowed
    c.shared_ms += shadow_ms_[shadow];
    return c;
}

double predictedError(const PlanScene& scene, const RenderSettings& settings, const PlanView& view) {
    const ViewWork work(scene, view);
    const std::optional<double> error = work.errs() ? planOf(settings.method)->error(settings, work) : std::nullopt;
    if (!error) return 0;
    // Settings finer than the plan's may ask for a shadow map that was not looked at: the next coarser one then.
    const PlanScene::Shadow* shadow = nullptr;
    for (const PlanScene::Shadow& one : scene.shadows)
        if (one.wanted >= settings.shadow_error && (!shadow || one.wanted < shadow->wanted)) shadow = &one;
    const double light = shadow ? work.light().lightFactor() * lightError(shadow->resolution.error) : 0;
    return bounded(std::hypot(*error, light));
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

} // namespace brume
