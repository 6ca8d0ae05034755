// Effect `propagation`: light that scatters more than once, for scattering = "propagation".
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "server/effects/effect.h"
#include "server/effects/propagation/cell_matter.h"
#include "server/effects/propagation/flux_sizes.h"
#include "server/effects/propagation/propagation.h"
#include "server/inputs/multiple_block.h"

namespace brume::effects::propagation {
namespace {

class PropagationEffect final : public Effect {
public:
    explicit PropagationEffect(const gpu::Device& device)
        : device_(device), hues_{Propagation(device), Propagation(device), Propagation(device)},
          linear_(device, VK_FILTER_LINEAR) {}

    void prepare(const EffectInputs& in, TickInputs& tick) override {
        has_matter_ = hasCellMatter(*tick.tick, in.extent.one_albedo);
        if (!has_matter_) return;
        const gpu::Multiple& multiple = tick.tick->multiple;
        const Key key{multiple.cells, tick.tick->map, tick.tick->falloff, tick.tick->emission, tick.tick->cold_albedo};
        if (!in.moved && key == made_for_) return;
        made_for_ = key;
        const FluxSizes sizes = fluxSizes(multiple.cells, multiple.channels, true, false);
        matter_.atLeast(device_, sizes.matter, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload,
                        "matter of cells");
        cellMatter(*tick.tick, in.particles, multiple.cells, sums_,
                   matter_.mapped<CellMatter>(sizes.matter / sizeof(CellMatter)));
        matter_.flush();
    }

    void recordHue(gpu::Commands& commands, const EffectInputs& in, TickInputs& tick) override {
        if (tick.tick->multiple.cells == 0) return;
        Propagation& hue = hues_[tick.hue];
        hue.record(commands, tick, in.all, has_matter_ ? &matter_ : nullptr);
        tick.resources.give(gpu::sampledImage("fluence", hue.image(), linear_));
        if (lightsSurfaces(*tick.tick, tick.settings->propagation))
            tick.resources.give(gpu::sampledImage("glow", hue.glow(), linear_));
    }
    void giveBack() override {
        for (Propagation& hue : hues_) hue.giveBack();
        matter_ = {}, sums_ = {}, made_for_ = {};
    }

private:
    struct Key {
        uint32_t cells = 0;
        gpu::LightMap map{};
        float falloff = 0;
        glm::vec3 emission{0}, cold_albedo{0};
        bool operator==(const Key& o) const {
            return cells == o.cells && falloff == o.falloff && emission == o.emission && cold_albedo == o.cold_albedo &&
                   std::ranges::equal(std::as_bytes(std::span(&map, 1)), std::as_bytes(std::span(&o.map, 1)));
        }
    };

    const gpu::Device& device_;
    std::array<Propagation, 3> hues_;
    gpu::Sampler linear_;
    bool has_matter_ = false; // True: matter_ holds CellMatter of every cell, which made_for_ made
    Key made_for_;
    gpu::Buffer matter_;
    std::vector<CellSum> sums_;
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) {
    return std::make_unique<PropagationEffect>(context.device);
}

} // namespace brume::effects::propagation
