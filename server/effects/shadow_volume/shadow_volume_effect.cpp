// Effect `shadow_volume`: the optical depth between the sun and everywhere in the medium, once per tick for all viewers
// and hues: optical depths are proportional to the extinction.
#include "server/effects/effect.h"
#include "server/effects/shadow_volume/shadow_volume.h"

namespace brume::effects::shadow_volume {
namespace {

class ShadowVolumeEffect final : public Effect {
public:
    explicit ShadowVolumeEffect(const EffectContext& context)
        : volume_(context.device, context.capacity, context.scene.medium.model == kEllipsoidMedium,
                  context.scene.render.shadow_map == "fronts"),
          linear_(context.device, VK_FILTER_LINEAR) {}

    void recordTick(gpu::Commands& commands, const EffectInputs& in, TickInputs& tick) override {
        if (volume_.record(commands, in.all.resources, *tick.tick, !in.moved, tick.tetrahedra, tick.volume)) ++version_;
        tick.sun_depth_version = version_;
        const gpu::Resource map = gpu::sampledImage("shadow_volume", volume_.image(), linear_);
        tick.resources.give(map);
        tick.resources.give(map.as("fluence")); // until there is light that scatters on,
        tick.resources.give(map.as("glow"));    // and falls on surfaces
    }

private:
    ShadowVolume volume_;
    gpu::Sampler linear_;
    uint64_t version_ = 0;
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) { return std::make_unique<ShadowVolumeEffect>(context); }

} // namespace brume::effects::shadow_volume
