// Method `gradients`: light is computed at few places of world space, once a tick for all viewers, and interpolated to
// nodes. An eye's rays read these as those of method `lit`.
#include "server/methods/gradients/radiance_grid.h"
#include "server/methods/lit/lit_rays.h"

namespace brume::methods::gradients {
namespace {

class Gradients : public LitBy<RadianceGrid> {
public:
    using LitBy::LitBy;

    std::span<const ViewGroup> prepare(std::span<const EyeInputs> eyes) override {
        for (RadianceGrid& grid : grids_) grid.follow(eyes);
        return LitBy::prepare(eyes);
    }

    LightWork workSince() override {
        LightWork work;
        for (RadianceGrid& grid : grids_) {
            const auto counts = grid.countsSince();
            work = work + LightWork{.places = counts[gpu::kPlacesLit],
                                    .samples = counts[gpu::kSamplesKept],
                                    .nodes = counts[gpu::kNodesLit],
                                    .holes = counts[gpu::kHoles]};
        }
        return work;
    }
};

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<Gradients>(context); }

} // namespace brume::methods::gradients
