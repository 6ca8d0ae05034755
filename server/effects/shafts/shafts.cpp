// Effect `shafts`: the part of the sun's light in the medium before each pixel of one eye that objects do not shadow.
#include <algorithm>

#include "common/scene_limits.h"
#include "server/effects/effect.h"
#include "server/effects/shafts/shafts_plan.h"
#include "server/gpu/binding_sizes.h"
#include "server/inputs/constants.h"
#include "server/medium/band_limit.h"
#include "shaders/shafts_comp.h"

namespace brume::effects::shafts {
namespace {

static_assert(limits::kObjects.hi == gpu::kMostBodies);

class Shafts final : public Effect {
public:
    explicit Shafts(const gpu::Device& device) : device_(device), program_(device, shafts_comp, "shafts") {}

    void prepare(const EffectInputs& in, TickInputs& tick) override {
        const VkDeviceSize bytes = tick.features.casters ? mostPixels(in.eyes) * kShaftBytesOfPixel : 0;
        sunlit_.atLeast(device_, std::max<VkDeviceSize>(bytes, gpu::kLeastBinding), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                        gpu::Memory::device, "shafts");
        tick.resources.give(gpu::storageBuffer("Sunlit", sunlit_));
    }

    void recordField(gpu::Commands& commands, const ViewGroup& group) override {
        const EyeInputs& in = *group.any;
        if (!in.shared->features.casters) return;
        const gpu::Commands::Pass pass(commands, "shafts", group.view());
        const uint32_t step = pixelStep(in.shared->settings->shading, group.rate, in.medium->count > 0);
        const gpu::Program& program = program_.with(constantsOf(group), {{gpu::kIdStep, step}});
        gpu::computeToCompute(commands.handle());
        for (uint32_t i = 0; i < group.count(); ++i) {
            program.bind(commands, group.resources, {group.blockOf(i)});
            const gpu::View& view = group.views[i];
            vkCmdDispatch(commands.handle(), gpu::groups(view.eye.size.x, gpu::kPixelTile),
                          gpu::groups(view.end, gpu::kPixelTile) - view.first / gpu::kPixelTile, 1);
        }
        gpu::computeToCompute(commands.handle());
    }

    uint64_t pictureBytes() const override { return sunlit_.size() > gpu::kLeastBinding ? sunlit_.size() : 0; }
    void giveBack() override { sunlit_ = {}; }

private:
    const gpu::Device& device_;
    gpu::Variants program_;
    gpu::Buffer sunlit_; // vec3[rows][columns] of the last eye's pixels, 0 ... 1
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) { return std::make_unique<Shafts>(context.device); }

} // namespace brume::effects::shafts
