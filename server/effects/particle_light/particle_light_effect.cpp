// Effect `particle_light`: light cached on the particles of every list that some eye sees, for methods that ask for it.
#include "server/effects/effect.h"
#include "server/effects/made_for.h"
#include "server/effects/particle_light/particle_light.h"

namespace brume::effects::particle_light {
namespace {

class ParticleLightEffect final : public Effect {
public:
    explicit ParticleLightEffect(const EffectContext& context)
        : device_(context.device), capacity_(context.capacity),
          ellipsoids_(context.scene.medium.model == kEllipsoidMedium) {}

    void recordHue(gpu::Commands& commands, const EffectInputs& in, TickInputs& tick) override {
        if (!in.needs.particle_light || in.needs.union_path) return;
        const float tolerance = tick.settings->tiles.light_tolerance;
        for (size_t i = 0; i < in.seen.size(); ++i) {
            MediumView& medium = *in.seen[i];
            if (i == lists_.size()) lists_.push_back({ParticleLight(device_, capacity_, ellipsoids_), {}});
            if (lists_[i].made_for.outdated({versionsOf(tick, medium), tolerance}))
                lists_[i].light.record(commands, medium.resources, medium.count, tolerance);
            medium.resources.give(gpu::storageBuffer("ParticleLights", lists_[i].light.buffer()));
        }
    }

private:
    struct Key {
        Versions versions;
        float tolerance = 0;
        bool operator==(const Key&) const = default;
    };
    struct List {
        ParticleLight light;
        MadeFor<Key> made_for;
    };

    const gpu::Device& device_;
    const uint32_t capacity_;
    const bool ellipsoids_;
    std::vector<List> lists_; // in the order of EffectInputs::seen
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) { return std::make_unique<ParticleLightEffect>(context); }

} // namespace brume::effects::particle_light
