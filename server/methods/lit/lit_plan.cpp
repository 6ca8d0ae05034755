// The lit grid as the plan sees it.
#include <fmt/format.h>

#include "server/methods/froxels/froxel_plan.h"

namespace brume::methods::lit {
namespace {

class Plan final : public FroxelPlan {
public:
    const char* name() const override { return "lit"; }
    const char* about() const override {
        return "froxels that read the light at nodes of world space, which all viewers share";
    }
    uint32_t shaders(const RenderSettings&) const override { return 0; }
    std::string text(const RenderSettings& s) const override {
        return fmt::format("lit grid, froxels of {}x{} pixels, {} slices", s.froxels.pixels, s.froxels.pixels,
                           s.froxels.slices);
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::lit
