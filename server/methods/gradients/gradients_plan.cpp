// Method `gradients` as the plan sees it.
#include <fmt/format.h>

#include "server/methods/froxels/froxel_plan.h"
#include "server/methods/gradients/light_shaders.h"

namespace brume::methods::gradients {
namespace {

class Plan final : public FroxelPlan {
public:
    const char* name() const override { return "gradients"; }
    const char* about() const override {
        return "froxels that read light at nodes, computed at few places and interpolated (Ren et al. 2008)";
    }
    uint32_t shaders(const RenderSettings& s) const override { return uint32_t(lightShaders(s.radiance)); }
    std::string text(const RenderSettings& s) const override {
        return fmt::format("light by {}, froxels of {}x{} pixels, {} slices", s.radiance.interpolation,
                           s.froxels.pixels, s.froxels.pixels, s.froxels.slices);
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::gradients
