// Interval shaded volumetrics as the plan sees them.
#include "common/settings.h"
#include "server/methods/isv/quadrature.h"
#include "server/methods/proxies/proxy_plan.h"

namespace brume::methods::isv {
namespace {

constexpr CostInfo kMedium{"isv", "medium", 22}; // fragments x (1 + steps)
constexpr const CostInfo* kCosts[] = {&costs::kOrder, &kMedium};
constexpr double kTetrahedronOfDisc = 0.37; // what a tetrahedron covers of the sphere around it, on average

constexpr double kLamp = 3.3;        // what a lamp in whose range all pixels are adds to the time, as a part of it
constexpr double kSoftShadows = 4.3; // times as long with 25 texels of the casters' map as with one, on a CPU driver

// True: its number of steps counts.
bool hasSteps(const IsvSettings& s) { return s.quadrature == "simpson" || s.quadrature == "transmittance"; }

class Plan final : public MethodPlan {
public:
    const char* name() const override { return "isv"; }
    const char* about() const override { return "interval shaded volumetrics, tetrahedron support (seed 000)"; }
    uint32_t variant(const RenderSettings& s) const override {
        return uint32_t(!s.isv.taylor_shadows) << 18 | uint32_t(s.isv.taylor_step > 0) << 17 |
               earlyReturnId(s.isv) << 15 | uint32_t(dropsNear(s.isv)) << 14 | uint32_t(isTurned(s.isv)) << 13 |
               uint32_t(s.isv.multiple > 0) << 12 | uint32_t(s.isv.soft_shadows) << 11 | uint32_t(!s.isv.fading) << 10 |
               quadratureId(s.isv) << 8 | s.isv.steps;
    }
    uint32_t shaders(const RenderSettings& s) const override { return variant(s); }
    std::string text(const RenderSettings& s) const override {
        std::string text = "isv, " + s.isv.quadrature;
        if (hasSteps(s.isv)) text += " " + std::to_string(s.isv.steps);
        if (!s.isv.fading) text += ", without fading";
        if (s.isv.soft_shadows) text += ", soft shadows";
        if (s.isv.multiple > 0) text += ", legacy term";
        if (isTurned(s.isv)) text += ", turned by chance";
        if (dropsNear(s.isv)) text += ", none at the near plane";
        if (s.isv.early_return != "sum") text += ", early return " + s.isv.early_return;
        return text;
    }
    std::string refusal(const RenderSettings& s) const override {
        const Limits steps = stepsAllowed(s.isv);
        if (steps.holds(s.isv.steps)) return {};
        return "isv.steps must be 1 ... " + std::to_string(int(steps.hi)) + " for quadrature '" + s.isv.quadrature +
               "'";
    }
    std::span<const CostInfo* const> costs() const override { return kCosts; }
    Extras extras() const override { return {.local_lights = true}; }
    bool draws(std::string_view model) const override { return model == kSumMedium || model == kEllipsoidMedium; }

    void addWays(const PlanScene&, const RenderSettings& wanted, bool asked, std::vector<RenderSettings>& ways,
                 std::string&) const override {
        RenderSettings way = wanted;
        if (!asked) way.isv = {.quadrature = "transmittance", .steps = 2};
        ways.push_back(way);
    }
    void addViewWork(const ViewWork& view, const RenderSettings& settings, Work& work) const override {
        addDrawnWork(view, work);
        const uint32_t steps = hasSteps(settings.isv) ? settings.isv.steps : 1; // what the others take, nearly
        work[kMedium] = view.fragments(kTetrahedronOfDisc * kDiscOfBox) * (1 + steps);
        if (settings.isv.soft_shadows && view.scene().features.casters) work[kMedium] *= kSoftShadows;
        work[kMedium] *= 1 + kLamp * view.litPixels() / view.pixels();
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::isv
