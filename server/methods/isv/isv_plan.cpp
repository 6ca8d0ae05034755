// Interval shaded volumetrics as the plan sees them.
#include <algorithm>

#include "common/scene_limits.h"
#include "server/methods/proxies/proxy_plan.h"

namespace brume::methods::isv {
namespace {

constexpr CostInfo kMedium{"isv", "medium", 22}; // fragments x (1 + steps)
constexpr const CostInfo* kCosts[] = {&costs::kOrder, &kMedium};
constexpr const char* kQuadratures[] = {"simpson", "transmittance", "analytic"};
constexpr double kTetrahedronOfDisc = 0.37; // what a tetrahedron covers of the sphere around it, on average
constexpr double kTruncation = 0.13;        // relative RMSE: tetrahedra leave out what is beyond their faces

class Plan final : public MethodPlan {
public:
    const char* name() const override { return "isv"; }
    const char* about() const override { return "interval shaded volumetrics, tetrahedron support (seed 000)"; }
    std::span<const char* const> quadratures() const override { return kQuadratures; }
    uint32_t variant(const RenderSettings& s) const override {
        const auto chosen = std::find(std::begin(kQuadratures), std::end(kQuadratures), quadratureOf(s));
        return uint32_t(chosen - std::begin(kQuadratures)) << 8 | s.steps;
    }
    std::string text(const RenderSettings& s) const override {
        return "isv, " + s.quadrature + " " + std::to_string(s.steps);
    }
    std::string refusal(const RenderSettings& s) const override {
        const Limits steps = s.quadrature == "transmittance" ? limits::kTransmittanceSteps : limits::kSteps;
        if (steps.holds(s.steps)) return {};
        return "steps must be 1 ... " + std::to_string(int(steps.hi)) + " for quadrature '" + s.quadrature + "'";
    }
    std::span<const CostInfo* const> costs() const override { return kCosts; }

    void addWays(const PlanScene&, const RenderSettings& wanted, bool asked, std::vector<RenderSettings>& ways,
                 std::string&) const override {
        RenderSettings way = wanted;
        if (!asked) way.quadrature = "transmittance", way.steps = 2;
        ways.push_back(way);
    }
    void addViewWork(const ViewWork& view, const RenderSettings& settings, Work& work) const override {
        addDrawnWork(view, work);
        work[kMedium] = view.fragments(kTetrahedronOfDisc * kDiscOfBox) * (1 + settings.steps);
    }
    double error(const RenderSettings&, const ViewWork&) const override { return kTruncation; }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::isv
