// Effect `propagation`: light of the sun that scatters more than once, for scattering = "propagation".
#include <array>

#include "server/effects/effect.h"
#include "server/effects/propagation/propagation.h"

namespace brume::effects::propagation {
namespace {

class PropagationEffect final : public Effect {
public:
    explicit PropagationEffect(const gpu::Device& device)
        : hues_{Propagation(device), Propagation(device), Propagation(device)}, linear_(device, VK_FILTER_LINEAR) {}

    void recordHue(gpu::Commands& commands, const EffectInputs& in, TickInputs& tick) override {
        if (tick.tick->multiple.cells == 0) return;
        Propagation& hue = hues_[tick.hue];
        hue.record(commands, tick, in.all);
        tick.resources.give(gpu::sampledImage("fluence", hue.image(), linear_));
    }
    void giveBack() override {
        for (Propagation& hue : hues_) hue.giveBack();
    }

private:
    std::array<Propagation, 3> hues_;
    gpu::Sampler linear_;
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) {
    return std::make_unique<PropagationEffect>(context.device);
}

} // namespace brume::effects::propagation
