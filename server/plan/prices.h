// Prices: costs and errors of ways to render the plan's views. What several ways have in common is counted once.
#pragma once

#include <optional>
#include <vector>

#include "server/plan/plan.h"

namespace brume {

// True: views have their own rates, since nobody asked for one.
bool haveOwnRates(const PlanInputs& inputs, const RenderSettings& settings);
// True: equal in all that the plan chooses.
bool sameWay(const RenderSettings& a, const RenderSettings& b);

// Rates and errors depend on what was set before. The order: setAllowed(), with all ways; setCompiledOnly(), where
// shaders are compiled behind; add() of each way; before(), and keepReference() if that way is kept.
class Prices {
public:
    // Both outlive it.
    Prices(const PlanInputs& inputs, const CostModel& model);

    // Sets what every view may have, from the least error that any of these ways has in it.
    void setAllowed(const std::vector<RenderSettings>& ways);

    // From now on views get compiled rates.
    void setCompiledOnly() { compiled_only_ = true; }

    // Appends those of the settings' views that are not compiled, whatever setCompiledOnly() says.
    void addMissing(const RenderSettings& way, std::vector<RenderSettings>& missing) const;

    // A candidate for each shadow map that the settings allow.
    void add(const RenderSettings& way, std::vector<Candidate>& all);
    Candidate of(const RenderSettings& settings) { return with(withoutShadow(settings), shadowOf(settings)); }

    // The way in use, if it is still one of `all`, with each view's rate as it is.
    std::optional<Candidate> before(const std::vector<Candidate>& all);
    // From now on rates are those of the view that PlanInputs::before was made for.
    void keepReference() {
        if (inputs_.before_deviation_px > 0 && deviation_ > 0) deviation_ = inputs_.before_deviation_px;
    }
    double deviation() const { return deviation_; }
    double lightErrorOf(const RenderSettings& settings) const {
        return lightError(scene_.shadows[shadowOf(settings)].resolution.error);
    }

    std::vector<PassCost> passes(const RenderSettings& settings) const;

private:
    size_t shadowOf(const RenderSettings& settings) const;
    RenderSettings withOwnRate(const ViewWork& view, RenderSettings way) const;
    // The way as it is drawn in that view.
    RenderSettings in(const ViewWork& view, const RenderSettings& way) const;
    // Nothing: the method has no law of it.
    std::optional<double> errorIn(const ViewWork& view, const RenderSettings& way) const;
    // The error of view `i`, of both parts that the laws predict, as measuring corrects it.
    double corrected(size_t i, const RenderSettings& way, double rays, double light) const;
    bool isMeasured(size_t i, const RenderSettings& way) const;
    // The error that view `i` may have, by both budgets.
    double budgetOf(size_t i, const RenderSettings& way) const;
    // errors_ are those of the last call.
    Candidate withoutShadow(const RenderSettings& way);
    Candidate with(Candidate c, size_t shadow) const;

    const PlanInputs& inputs_;
    const PlanScene& scene_; // of inputs_
    const CostModel& model_;
    std::vector<ViewWork> views_;
    bool inside_ = false; // True: some eye is in the medium
    bool compiled_only_ = false;
    double deviation_ = 0; // Plan::reference_deviation_px
    std::vector<double> shadow_ms_;
    std::vector<double> allowed_, errors_; // by view: budgets that it may have; error without the light's
};

} // namespace brume
