// Sprites as the plan sees them.
#include <fmt/format.h>

#include "server/effects/union_path/union_path_plan.h"
#include "server/methods/proxies/proxy_plan.h"

namespace brume::methods::sprites {
namespace {

constexpr CostInfo kMedium{"sprites", "medium", 30}; // fragments
constexpr const CostInfo* kCosts[] = {&costs::kOrder, &kMedium};

class Plan final : public MethodPlan {
public:
    const char* name() const override { return "sprites"; }
    const char* about() const override {
        return "pictures of smoke that face the camera, lit behind the union of balls (Mattsson 2022)";
    }
    uint32_t variant(const RenderSettings& s) const override {
        return s.sprites.maps == "baked" ? 0 : s.sprites.maps == "even" ? 1 : 2;
    }
    uint32_t shaders(const RenderSettings&) const override { return 0; } // maps are no shaders
    std::string text(const RenderSettings& s) const override { return fmt::format("sprites, {} maps", s.sprites.maps); }
    std::span<const CostInfo* const> costs() const override { return kCosts; }
    bool draws(std::string_view model) const override { return model == kUnionMedium; }
    bool hasClosedForms() const override { return false; }
    // It is `auto`'s choice in a union medium, though its error has no law.
    void addWays(const PlanScene&, const RenderSettings& way, bool, std::vector<RenderSettings>& ways,
                 std::string&) const override {
        ways.push_back(way);
    }
    void addSharedWork(const PlanScene& scene, const RenderSettings&, Work& work) const override {
        work[costs::kUnionPath] = scene.particles;
    }
    void addViewWork(const ViewWork& view, const RenderSettings&, Work& work) const override {
        addDrawnWork(view, work);
        work[kMedium] = view.fragments(1);
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::sprites
