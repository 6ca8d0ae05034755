#include "server/plan/plan.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <tuple>

#include <fmt/format.h>

#include "server/render/medium_grid.h"
#include "server/render/shading.h"

namespace brume {
namespace {

constexpr uint32_t kRates[] = {1, 2, 4, 6, 8, 12, 16};
constexpr uint32_t kSlabCounts[] = {8, 16, 24, 32, 48, 64, 96, 128, 192, 256};
constexpr float kGridSpacings[] = {0.2f, 0.35f, 0.5f, 0.7f}; // the first one is sampled cubically

// What is in use stays while it is at most so much dearer, and its error so much larger, than what would be chosen anew: a camera
// on the edge between two ways does not change them every tick.
constexpr double kDearer = 1.25, kWorse = 1.1;
// Where nothing holds the budgets: the cheapest of those whose error is at most so many times the least that there is.
constexpr double kNearBest = 1.1;
// Overload trades error away up to so many times the budget.
constexpr double kMostRelaxed = 10;

// The way with every number of rays and slabs that it leaves open.
void addRays(RenderSettings way, std::vector<RenderSettings>& ways) {
    const uint32_t wanted_rate = way.rate, wanted_slabs = way.slabs;
    for (const uint32_t rate : kRates)
        for (const uint32_t slabs : kSlabCounts) {
            way.rate = wanted_rate ? wanted_rate : rate;
            way.slabs = wanted_slabs ? wanted_slabs : slabs;
            const bool again = (wanted_rate && rate != kRates[0]) || (wanted_slabs && slabs != kSlabCounts[0]);
            if (!again) ways.push_back(way);
        }
}

// Cheapest first is not known: all combinations of what is left open, by `wanted_method`. `refused` says what the scene does not
// allow.
std::vector<RenderSettings> waysOf(const PlanInputs& inputs, const std::string& wanted_method, std::string& refused) {
    const RenderSettings& wanted = inputs.scene.wanted;
    std::vector<RenderSettings> ways;
    for (const std::string& method : inputs.methods) {
        if (wanted_method != kAutoMethod && wanted_method != method) continue;
        RenderSettings way = wanted;
        way.method = method;
        if (method == "slabs") {
            addRays(way, ways);
        } else if (method == "grid") {
            for (const float spacing : kGridSpacings) {
                if (wanted.grid > 0 && spacing != kGridSpacings[0]) break;
                way.grid = wanted.grid > 0 ? wanted.grid : spacing;
                const std::string why = gridRefusal(inputs.scene.extent, way);
                if (why.empty()) addRays(way, ways);
                refused = why.empty() ? why : "grid: " + why; // by the coarsest one
            }
        } else if (method == "tiles" && wanted_method == kAutoMethod) {
            for (const char* quadrature : {"cached", "hermite"}) {
                way.quadrature = quadrature;
                ways.push_back(way);
            }
        } else {
            if (method == "isv" && wanted_method == kAutoMethod) way.quadrature = "transmittance", way.steps = 2;
            ways.push_back(way);
        }
    }
    return ways;
}

double msOf(const Work& work, const CostModel& model) {
    double ns = 0;
    for (size_t i = 0; i < kCosts; ++i) ns += work[i] * model.ns[i];
    return ns * 1e-6;
}

// How much farther apart rays may be than the plan says, so that rates stay: less than the steps between rates.
constexpr double kFarther = 1.15;
// Pixels of a deviation above which the coarsest rate is finer than needs be: other views would get too many rays by it.
constexpr double kMostDeviation = double(std::end(kRates)[-1]) / double(kRaysPerDeviation);

double errorOf(const RenderSettings& way, const ViewWork& view) {
    if (!view.sees()) return 0;
    const double own = methodError(way, view.inside());
    if (!marches(way)) return own;
    const double nodes = way.method == "grid" ? gridError(double(way.grid)) : 0;
    return std::hypot(std::hypot(own, nodes), rayError(view.raySpacing(way.rate)),
                      slabError(view.slabThickness(way.slabs), view.deviationDepth(), view.inside()));
}

// Whether views have their own rates: nobody asked for one, and no shaders have to be compiled for long.
bool haveOwnRates(const PlanInputs& inputs, const RenderSettings& settings) {
    return marches(settings) && inputs.scene.wanted.rate == 0 && (inputs.compiled || !inputs.scene.features.opaque);
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
        for (const PlanScene::Shadow& shadow : scene_.shadows) shadow_ms_.push_back(msOf(shadowWork(scene_, shadow), model));
    }

    // A candidate for each shadow map that the settings allow.
    void add(const RenderSettings& way, std::vector<Candidate>& all) const {
        const Candidate bare = withoutShadow(way);
        for (size_t i = 0; i < scene_.shadows.size(); ++i)
            if (scene_.shadows[i].wanted <= scene_.wanted.shadow_error) all.push_back(with(bare, i));
    }
    Candidate of(const RenderSettings& settings) const { return with(withoutShadow(settings), shadowOf(settings)); }

    double deviation() const { return deviation_; }

    std::vector<PassCost> passes(const RenderSettings& settings) const {
        Work shared = sharedWork(scene_, settings), each{};
        const Work shadow = shadowWork(scene_, scene_.shadows[shadowOf(settings)]);
        for (size_t i = 0; i < kCosts; ++i) shared[i] += shadow[i];
        for (const ViewWork& view : views_) {
            const Work work = view.of(in(view, settings));
            for (size_t i = 0; i < kCosts; ++i) each[i] += work[i];
        }
        std::vector<PassCost> all;
        for (size_t i = 0; i < kCosts; ++i) {
            if (shared[i] > 0) all.push_back({info(Cost(i)).pass, true, shared[i] * model_.ns[i] * 1e-6});
            if (each[i] > 0) all.push_back({info(Cost(i)).pass, false, each[i] * model_.ns[i] * 1e-6});
        }
        return all;
    }

private:
    size_t shadowOf(const RenderSettings& settings) const {
        const auto same = [&](const PlanScene::Shadow& s) { return s.wanted == settings.shadow_error; };
        return size_t(std::find_if(scene_.shadows.begin(), std::prev(scene_.shadows.end()), same) - scene_.shadows.begin());
    }
    // With the view's own rate.
    RenderSettings in(const ViewWork& view, RenderSettings way) const {
        if (haveOwnRates(inputs_, way) && deviation_ > 0) way.rate = rateFor(way.rate, view.deviation() / deviation_);
        return way;
    }
    Candidate withoutShadow(const RenderSettings& way) const {
        Candidate c{.settings = way, .shared_ms = msOf(sharedWork(scene_, way), model_)};
        for (const ViewWork& view : views_) {
            const RenderSettings own = in(view, way);
            c.views_ms += msOf(view.of(own), model_);
            c.error = std::max(c.error, errorOf(own, view));
        }
        return c;
    }
    Candidate with(Candidate c, size_t shadow) const {
        c.settings.shadow_error = scene_.shadows[shadow].wanted;
        c.error =
            c.error > 0 ? std::hypot(c.error, lightError(scene_.shadows[shadow].resolution.error)) : 0; // 0: nothing is seen
        c.flip = flipOf(c.error, inside_);
        c.shared_ms += shadow_ms_[shadow];
        return c;
    }

    const PlanInputs& inputs_;
    const PlanScene& scene_; // of inputs_
    const CostModel& model_;
    std::vector<ViewWork> views_;
    bool inside_ = false;  // some view is
    double deviation_ = 0; // Plan::deviation
    std::vector<double> shadow_ms_;
};

bool sameWay(const RenderSettings& a, const RenderSettings& b) {
    return a.method == b.method && a.rate == b.rate && a.slabs == b.slabs && a.grid == b.grid && a.quadrature == b.quadrature &&
           a.steps == b.steps && a.shadow_error == b.shadow_error;
}

// Smaller is better: whether it is outside the budgets, and then what counts there.
using Rank = std::tuple<int, double, double>;

// The best of each method and rate but the chosen one, with why it was not taken.
std::vector<Candidate> othersOf(const std::vector<Candidate>& all, const Candidate& chosen, const RenderSettings& wanted,
                                const std::function<Rank(const Candidate&)>& rank) {
    std::vector<Candidate> others;
    for (const Candidate& c : all) {
        RenderSettings otherwise = c.settings; // another shadow map alone is no other way
        otherwise.shadow_error = chosen.settings.shadow_error;
        if (sameWay(otherwise, chosen.settings)) continue;
        const auto alike = [&](const Candidate& o) {
            return o.settings.method == c.settings.method && o.settings.rate == c.settings.rate &&
                   o.settings.quadrature == c.settings.quadrature;
        };
        const auto rival = std::find_if(others.begin(), others.end(), alike);
        if (rival == others.end()) {
            others.push_back(c);
            continue;
        }
        if (rank(c) < rank(*rival)) *rival = c;
    }
    for (Candidate& c : others)
        c.why_not = c.error > double(wanted.error) ? fmt::format("error above {:.2g} %", 100 * wanted.error)
                    : c.flip > double(wanted.flip) ? fmt::format("FLIP above {:.2g}", wanted.flip)
                    : c.ms() > chosen.ms()         ? fmt::format("{:.1f} times the time", c.ms() / chosen.ms())
                                                   : "not clearly better than what is in use";
    return others;
}

} // namespace

std::string checkWanted(const RenderSettings& wanted) {
    RenderSettings named = wanted;
    if (wanted.method == kAutoMethod) named.method = methods().front().name;
    std::string wrong = checkSettings(named);
    if (const size_t at = wrong.find("there are: "); at != wrong.npos && wrong.starts_with("no method"))
        wrong.insert(at + 11, std::string(kAutoMethod) + ", ");
    return wrong;
}

// The constants are upper bounds of what was measured at 640x360 on cloud, cloud-5000, tubes and props from outside and from
// within, each cause by itself; docs/results/plan.md has the predictions for views that they do not come from.

// A cubic B-spline errs by the fourth derivative, which of Gaussians grows on with every order: between spacings of a half and
// two that is the power 4.5.
double rayError(double spacing) { return 0.0055 * std::pow(spacing, 4.5); }

// Within a slab light and extinction vary together to second order in its thickness: by the depth that a slab has, up to where
// what lies behind is hidden. The eye that is in the medium sees each slab by itself; from outside the rim, where little is
// scattered, counts too. Above 1.43 slabs widen the particles: from there on the error grows as the fourth power.
double slabError(double thickness, double depth, bool inside) {
    const double curvature = inside ? std::min(0.065 * depth, 0.0145) : std::min(0.06 * depth, 0.0085);
    return curvature * thickness * thickness * (1 + std::pow(thickness / 2, 4));
}

// The map's estimate is a mean over views; some see up to 1.4 times as much of it.
double lightError(double estimated) { return 1.25 * estimated; }

// The largest of cloud, cloud-5000, tubes, plume and grid_test's particles of several sizes: 0.3 % at 0.5, where cloud has 0.06
// %. Sampled linearly; cubically.
double gridError(double spacing) {
    return spacing >= double(kCubicBelow) ? 0.012 * std::pow(spacing, 2) : 0.0016 * std::pow(spacing, 4);
}

double methodError(const RenderSettings& settings, bool inside) {
    if (marches(settings)) return 2e-4;
    if (settings.method == "sphere" || quadratureOf(settings) == "hermite") return 0.03;
    if (settings.method == "tiles") return inside ? 0.055 : 0.03;
    return 0.13; // tetrahedra leave out what is beyond their faces
}

// FLIP's definition for an error e of the luminance Y all over a picture: 0.0575 (38.7 Y^(1/3) e)^0.7, which is 0.56 e^0.7 for Y
// = 0.3 and 0.7 e^0.7 for 0.8. From outside less of the medium is bright, and the error is in fewer places.
double flipOf(double error, bool inside) { return std::min((inside ? 0.65 : 0.5) * std::pow(error, 0.7), 1.0); }

uint32_t rateFor(uint32_t rate, double part) {
    if (part > 1 / kFarther && part < kFarther) return rate;
    uint32_t own = 1;
    for (const uint32_t r : kRates)
        if (r <= kFarther * part * rate) own = r;
    return own;
}

std::optional<RenderSettings> relaxed(const RenderSettings& settings, uint32_t step, const Allowed& allowed) {
    const bool slabs = marches(settings);
    for (uint32_t tries = 0; tries < 3; ++tries) {
        RenderSettings coarser = settings;
        const uint32_t what = (step + tries) % 3;
        if (what == 0 && slabs && settings.slabs > kSlabCounts[0]) {
            for (const uint32_t fewer : kSlabCounts)
                if (fewer < settings.slabs) coarser.slabs = fewer;
        } else if (what == 1 && slabs && settings.rate < std::end(kRates)[-1]) {
            coarser.rate = *std::upper_bound(std::begin(kRates), std::end(kRates), settings.rate);
        } else if (what == 2 && 2 * settings.shadow_error <= kCoarsestShadow) {
            coarser.shadow_error = 2 * settings.shadow_error;
        } else {
            continue;
        }
        if (!allowed || allowed(coarser)) return coarser;
    }
    return {};
}

Plan makePlan(const PlanInputs& inputs, const CostModel& model) {
    const RenderSettings& wanted = inputs.scene.wanted;
    const Prices prices(inputs, model);
    std::vector<Candidate> all;
    Plan plan;
    std::vector<RenderSettings> ways = waysOf(inputs, wanted.method, plan.refused);
    if (ways.empty()) {
        std::string again;
        ways = waysOf(inputs, kAutoMethod, again);
    }
    for (const RenderSettings& way : ways) prices.add(way, all);

    const auto holds = [&](const Candidate& c) { return c.error <= double(wanted.error) && c.flip <= double(wanted.flip); };
    const auto by_error = [](const Candidate& a, const Candidate& b) { return a.error < b.error; };
    const double least = std::min_element(all.begin(), all.end(), by_error)->error;
    const auto rank = [&](const Candidate& c) -> Rank {
        if (holds(c)) return {0, c.ms(), c.error};
        return c.error <= kNearBest * least ? Rank{1, c.ms(), c.error} : Rank{2, c.error, c.ms()};
    };
    plan.views = inputs.views.size();
    plan.chosen =
        *std::min_element(all.begin(), all.end(), [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); });
    if (inputs.before) {
        const auto used =
            std::find_if(all.begin(), all.end(), [&](const Candidate& c) { return sameWay(c.settings, *inputs.before); });
        const bool stays = used != all.end() && used->ms() <= kDearer * plan.chosen.ms() &&
                           used->error <= kWorse * std::max(plan.chosen.error, double(wanted.error)) &&
                           used->flip <= kWorse * std::max(plan.chosen.flip, double(wanted.flip));
        if (stays) {
            plan.kept = !sameWay(used->settings, plan.chosen.settings);
            plan.chosen = *used;
        }
    }
    plan.base = plan.chosen.settings;
    while (plan.relaxed < inputs.relaxed) {
        const auto next = relaxed(plan.chosen.settings, plan.relaxed, [&](const RenderSettings& way) {
            return prices.of(way).error <= kMostRelaxed * double(wanted.error);
        });
        if (!next) break;
        plan.finer_ms = plan.chosen.ms();
        plan.chosen = prices.of(*next);
        ++plan.relaxed;
    }
    plan.deviation = haveOwnRates(inputs, plan.chosen.settings) ? prices.deviation() : 0;
    plan.within = holds(plan.chosen);
    plan.rests_ms = prices.of(finer(plan.chosen.settings)).ms();
    plan.passes = prices.passes(plan.chosen.settings);
    plan.others = othersOf(all, plan.chosen, wanted, rank);
    return plan;
}

RenderSettings finer(RenderSettings settings) {
    if (!marches(settings)) return settings;
    if (settings.rate > 1) settings.rate /= 2;
    settings.slabs = std::min(2 * settings.slabs, 512u);
    return settings;
}

} // namespace brume
