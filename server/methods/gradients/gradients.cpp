// Method `gradients`: light is computed at few places of world space, once a tick for all viewers, and interpolated to
// nodes. An eye's rays read these as those of method `lit`.
#include "server/methods/gradients/radiance_grid.h"
#include "server/methods/lit/lit_rays.h"

namespace brume::methods::gradients {
namespace {

class Gradients : public LitRays {
public:
    explicit Gradients(const MethodContext& context)
        : LitRays(context), light_{RadianceGrid(context.device), RadianceGrid(context.device),
                                   RadianceGrid(context.device)} {}

    LightWork workSince() override {
        LightWork work;
        for (RadianceGrid& light : light_) {
            const auto counts = light.countsSince();
            work = work + LightWork{.places = counts[gpu::kPlacesLit],
                                    .samples = counts[gpu::kSamplesKept],
                                    .nodes = counts[gpu::kNodesLit],
                                    .holes = counts[gpu::kHoles]};
        }
        return work;
    }

private:
    Light recordLight(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium,
                      const GridPass& nodes) override {
        RadianceGrid& light = light_[tick.hue];
        light.record(commands, tick, medium, nodes);
        return {light.shape(), light.light()};
    }

    RadianceGrid light_[3]; // of each hue: light is dimmed as its extinction is
};

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<Gradients>(context); }

} // namespace brume::methods::gradients
