// Effect `particle_fit`: the light on all particles, for viewers who draw by themselves. It runs when somebody does.
#include "shaders/shared/particle_fit.h"
#include "server/effects/effect.h"
#include "server/inputs/constants.h"
#include "server/inputs/multiple_block.h"
#include "shaders/lit_particles_comp.h"

namespace brume::effects::particle_fit {
namespace {

class ParticleFitEffect final : public Effect {
public:
    explicit ParticleFitEffect(const gpu::Device& device) : program_(device, lit_particles_comp, "lit_particles") {}

    void recordHue(gpu::Commands& commands, const EffectInputs& in, TickInputs& tick) override {
        if (!in.fits || in.fitted->count == 0) return;
        const MediumView& medium = *in.fitted;
        const gpu::Resource own = gpu::storageBuffer("ParticleFits", *in.fits, tick.hue * in.fits_stride,
                                                     medium.count * sizeof(gpu::ParticleFit));
        gpu::Constants constants = constantsOf(tick.features);
        constants.push_back({gpu::kIdScattering, scatteringOf(tick.tick->multiple)});
        const gpu::Commands::Pass pass(commands, "particle fit");
        gpu::computeToCompute(commands.handle());
        program_.with(constants).bind(commands, medium.resources, {own});
        vkCmdDispatch(commands.handle(), gpu::groups(medium.count, 64), 1, 1);
    }

private:
    gpu::Variants program_;
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) {
    return std::make_unique<ParticleFitEffect>(context.device);
}

} // namespace brume::effects::particle_fit
