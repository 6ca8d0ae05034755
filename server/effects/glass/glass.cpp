// Effect `glass`: pictures through sheets of glass as sums of layers of the medium (shaders/shared/glass.h). The medium
// is drawn before surfaces, and once more for each layer, up to the nearest sheet of each pixel, to the second one, and
// so on.
#include <algorithm>

#include "server/effects/effect.h"
#include "server/effects/glass/glass_block.h"
#include "server/effects/glass/glass_plan.h"
#include "server/gpu/variants.h"
#include "shaders/glass_comp.h"

namespace brume::effects::glass {
namespace {

class GlassLayers final : public Effect {
public:
    GlassLayers(const gpu::Device& device, std::span<const Glass> glasses)
        : device_(device), glasses_(glasses.begin(), glasses.end()), program_(device, glass_comp, "glass") {
        if (glasses_.empty()) return;
        sheets_ = gpu::Buffer(device, glasses_.size() * sizeof(gpu::GlassSheet), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                              gpu::Memory::upload, "glass");
        std::ranges::transform(glasses_, sheets_.mapped<gpu::GlassSheet>(glasses_.size()).begin(), glassSheet);
        sheets_.flush();
    }

    void prepare(const EffectInputs& in, TickInputs& tick) override {
        if (tick.features.glass)
            sums_.atLeast(device_, mostPixels(in.eyes) * kGlassBytesOfPixel, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                          gpu::Memory::device, "sums of layers");
    }

    uint32_t layersOf(const EyeInputs& in) const override {
        return glassLayers(glasses_, in.pose, frustumOf(in.pose, in.size.width, in.size.height));
    }

    void recordLayer(gpu::Commands& commands, const ViewGroup& group, uint32_t drawn, uint32_t layers) override {
        const EyeInputs& in = *group.any;
        const gpu::Commands::Pass pass(commands, "glass", in.view);
        const gpu::View& view = group.views.front();
        const gpu::GlassPush push{uint32_t(glasses_.size()), drawn, layers, view.first, view.end};
        gpu::everythingBefore(commands.handle());
        program_.with().bind(commands, in.resources,
                             {gpu::storageBuffer("Sheets", sheets_), gpu::storageBuffer("Sums", sums_)}, push);
        vkCmdDispatch(commands.handle(), gpu::groups(in.size.width, 8), gpu::groups(push.end - push.first, 8), 1);
        gpu::everythingBefore(commands.handle());
    }

    uint64_t pictureBytes() const override { return sums_.size(); }
    void giveBack() override { sums_ = {}; }

private:
    const gpu::Device& device_;
    const std::vector<Glass> glasses_;
    gpu::Variants program_;
    gpu::Buffer sheets_; // gpu::GlassSheet[]
    gpu::Buffer sums_;   // GlassSum[row][column] of shaders/glass.comp
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) {
    return std::make_unique<GlassLayers>(context.device, context.scene.glasses);
}

} // namespace brume::effects::glass
