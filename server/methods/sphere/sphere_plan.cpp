// Sphere proxies as the plan sees them.
#include "server/methods/proxies/proxy_plan.h"

namespace brume::methods::sphere {
namespace {

constexpr CostInfo kMedium{"sphere", "medium", 20}; // fragments
constexpr const CostInfo* kCosts[] = {&costs::kOrder, &kMedium};

class Plan final : public MethodPlan {
public:
    const char* name() const override { return "sphere"; }
    const char* about() const override { return "sphere proxies, the full Gaussian, 2-point Gauss-Hermite"; }
    uint32_t shaders(const RenderSettings&) const override { return 0; }
    std::span<const CostInfo* const> costs() const override { return kCosts; }
    void addWays(const PlanScene&, const RenderSettings& way, bool, std::vector<RenderSettings>& ways,
                 std::string&) const override {
        ways.push_back(way);
    }
    void addViewWork(const ViewWork& view, const RenderSettings&, Work& work) const override {
        addDrawnWork(view, work);
        work[kMedium] = view.fragments(kDiscOfBox);
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::sphere
