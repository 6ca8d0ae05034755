// Froxels as the plan sees them: used where a scene names them.
#include <algorithm>

#include <fmt/format.h>

#include "common/scene_limits.h"

#include "server/methods/grid/node_grid_plan.h"
#include "server/plan/method_plan.h"

namespace brume::methods::froxels {
namespace {

class Plan final : public MethodPlan {
public:
    const char* name() const override { return "froxels"; }
    const char* about() const override {
        return "cells of the view volume with one sample of medium and light each (Hillaire 2015)";
    }
    std::string text(const RenderSettings& s) const override {
        return fmt::format("froxels of {}x{} pixels, {} slices, shadows by {}", s.froxels.pixels, s.froxels.pixels,
                           s.froxels.slices, s.froxels.shadows);
    }
    uint64_t bytesPerParticle() const override { return sizeof(gpu::SlabMember); }
    bool drawsFogAndLocalLights() const override { return true; }
    RenderSettings finer(const RenderSettings& settings) const override {
        RenderSettings fine = settings;
        fine.froxels.pixels = std::max(settings.froxels.pixels / 2, 1u);
        fine.froxels.slices = std::min(2 * settings.froxels.slices, uint32_t(limits::kSlices.hi));
        return fine;
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::froxels
