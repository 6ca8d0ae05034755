// Method `march` as the plan sees it.
#include <fmt/format.h>

#include "server/methods/froxels/froxel_plan.h"
#include "server/methods/march/march_shaders.h"

namespace brume::methods::march {
namespace {

class Plan final : public FroxelPlan {
public:
    const char* name() const override { return "march"; }
    const char* about() const override {
        return "a few samples along every pixel's ray, dithered and blurred (KTH 2018)";
    }
    uint32_t shaders(const RenderSettings& s) const override {
        const auto blur = blurOf(s.march);
        return jitterOf(s.march) << 8 | (blur ? *blur + 1 : 0);
    }
    std::string text(const RenderSettings& s) const override {
        return fmt::format("{} samples a ray, dither {} by {}, blur {}", s.march.samples, s.march.dither,
                           s.march.jitter, s.march.blur);
    }
    RenderSettings finer(const RenderSettings& settings) const override {
        RenderSettings fine = settings;
        fine.march.samples = std::min(2 * settings.march.samples, uint32_t(limits::kMarchSamples.hi));
        return fine;
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::march
