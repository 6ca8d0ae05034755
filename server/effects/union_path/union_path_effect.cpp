// Effect `union_path`: light of the sun behind the union of balls, for methods that ask for it and for surfaces behind
// a medium of balls.
#include "server/effects/effect.h"
#include "server/effects/union_path/union_path.h"

namespace brume::effects::union_path {
namespace {

class UnionPathEffect final : public Effect {
public:
    explicit UnionPathEffect(const gpu::Device& device) : path_(device) {}

    void prepare(const EffectInputs& in, TickInputs& tick) override {
        needed_ = (tick.features.balls && tick.features.opaque) || in.needs.union_path;
        if (needed_) {
            // The buffer holds the light of one hue.
            if (in.hues > 1 || of_a_hue_) path_.invalidate();
            of_a_hue_ = in.hues > 1;
            path_.prepare(in.simulation, in.now, *tick.tick, in.all.version, tick.objects_version);
        }
        const auto give = [&](const char* name, const gpu::Buffer& buffer) { // without balls it is not read
            tick.resources.give(buffer ? gpu::storageBuffer(name, buffer) : tick.resources.storage("Objects").as(name));
        };
        give("UnionBits", path_.bins());
        give("UnionLights", path_.lights());
    }
    void recordHue(gpu::Commands& commands, const EffectInputs& in, TickInputs& /*tick*/) override {
        if (needed_) path_.record(commands, in.all);
        if (in.needs.union_path) in.all.resources.give(gpu::storageBuffer("ParticleLights", path_.lights()));
    }
    void giveBack() override { path_.giveBack(); }
    void forget() override { path_.invalidate(); }

private:
    UnionPath path_;
    bool needed_ = false;   // True: some pass of this submission reads it
    bool of_a_hue_ = false; // True: the buffer's light is that of the last one of several hues
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) { return std::make_unique<UnionPathEffect>(context.device); }

} // namespace brume::effects::union_path
