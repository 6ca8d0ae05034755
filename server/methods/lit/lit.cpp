// Method `lit`: the light of all lamps and of the sun is kept at nodes of world space, once a tick for all viewers. An
// eye's rays read it once in each slice, however many lights there are, and add those that are near one by one.
#include "server/methods/lit/lit_rays.h"

namespace brume::methods::lit {
namespace {

class Lit : public LitRays {
public:
    explicit Lit(const MethodContext& context)
        : LitRays(context), lit_{LitGrid(context.device), LitGrid(context.device), LitGrid(context.device)} {}

private:
    Light recordLight(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium,
                      const GridPass& nodes) override {
        LitGrid& lit = lit_[tick.hue];
        lit.record(commands, tick, medium, nodes);
        return {lit.shape(), lit.light()};
    }

    LitGrid lit_[3]; // of each hue: light is dimmed as its extinction is
};

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<Lit>(context); }

} // namespace brume::methods::lit
