// Froxels as the plan sees them.
#include <fmt/format.h>

#include "server/methods/froxels/froxel_plan.h"
#include "server/methods/froxels/froxel_shaders.h"

namespace brume::methods::froxels {
namespace {

class Plan final : public FroxelPlan {
public:
    const char* name() const override { return "froxels"; }
    const char* about() const override {
        return "cells of the view volume with one sample of medium and light each (Hillaire 2015)";
    }
    uint32_t shaders(const RenderSettings& s) const override {
        const FroxelShaders shaders = shadersFor(s.froxels);
        return shaders.shadows << 1 | uint32_t(shaders.history);
    }
    std::string text(const RenderSettings& s) const override {
        return fmt::format("froxels of {}x{} pixels, {} slices, shadows by {}", s.froxels.pixels, s.froxels.pixels,
                           s.froxels.slices, s.froxels.shadows);
    }
};

} // namespace

const MethodPlan& plan() {
    static const Plan kPlan;
    return kPlan;
}

} // namespace brume::methods::froxels
