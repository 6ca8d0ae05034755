// The lit grid as the plan sees it: used where a scene names it.
#include <algorithm>

#include <fmt/format.h>

#include "common/scene_limits.h"

#include "server/methods/grid/node_grid_plan.h"
#include "server/plan/method_plan.h"

namespace brume::methods::lit {
namespace {

class Plan final : public MethodPlan {
public:
    const char* name() const override { return "lit"; }
    const char* about() const override {
        return "froxels that read the light at nodes of world space, which all viewers share";
    }
    std::string text(const RenderSettings& s) const override {
        return fmt::format("lit grid, froxels of {}x{} pixels, {} slices", s.froxels.pixels, s.froxels.pixels,
                           s.froxels.slices);
    }
    uint64_t bytesPerParticle() const override { return sizeof(gpu::SlabMember); }
    bool drawsFogAndLocalLights() const override { return true; }
    RenderSettings finer(const RenderSettings& settings) const override {
        RenderSettings fine = settings;
        fine.froxels.pixels = std::max(settings.froxels.pixels / 2, 1u);
        fine.froxels.slices = std::min(2 * settings.froxels.slices, uint32_t(limits::kSlices.hi));
        return fine;
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::lit
