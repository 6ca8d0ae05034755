// Method `tetrahedra` as the plan sees it.
#include <fmt/format.h>

#include "server/inputs/multiple_block.h"
#include "server/plan/method_plan.h"

namespace brume::methods::tetrahedra {
namespace {

constexpr CostInfo kMedium{"tetrahedra", "medium", 9}; // pixels x tetrahedra on a ray
constexpr const CostInfo* kCosts[] = {&kMedium};

class Plan final : public MethodPlan {
public:
    const char* name() const override { return "tetrahedra"; }
    const char* about() const override {
        return "rays that walk through a mesh of tetrahedra from neighbour to neighbour (seed 000)";
    }
    uint32_t variant(const RenderSettings& s) const override { return s.tetrahedra.nodes; }
    uint32_t shaders(const RenderSettings& s) const override {
        return kScatteringShaders * variant(s) + scatteringShaders(s);
    }
    std::string text(const RenderSettings& s) const override {
        return fmt::format("tetrahedra, light at {} places in each", s.tetrahedra.nodes);
    }
    std::string refusal(const RenderSettings& s) const override {
        if (limits::kTetrahedraNodes.holds(s.tetrahedra.nodes)) return {};
        return fmt::format("tetrahedra.nodes must be {} ... {}", limits::kTetrahedraNodes.lo,
                           limits::kTetrahedraNodes.hi);
    }
    std::span<const CostInfo* const> costs() const override { return kCosts; }
    bool draws(std::string_view model) const override { return model == kTetrahedraMedium; }
    bool drawsMultiple() const override { return true; }
    // It is `auto`'s choice in such a medium, though its error has no law.
    void addWays(const PlanScene&, const RenderSettings& way, bool, std::vector<RenderSettings>& ways,
                 std::string&) const override {
        ways.push_back(way);
    }
    void addViewWork(const ViewWork& view, const RenderSettings&, Work& work) const override {
        work[costs::kOpaque] = view.pixels() * (1 + view.scene().objects);
        work[costs::kCompose] = view.pixels();
        work[kMedium] = view.pixels() * tetrahedraOnRay(view.scene().particles);
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::tetrahedra
