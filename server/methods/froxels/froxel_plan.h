// FroxelPlan: what the plan knows of methods that march froxels (froxel_volume.h). They are used where a scene names
// them: their errors have no law.
#pragma once

#include <algorithm>

#include "common/scene_limits.h"
#include "server/methods/grid/node_grid_plan.h"
#include "server/plan/method_plan.h"

namespace brume {

class FroxelPlan : public MethodPlan {
public:
    uint64_t bytesPerParticle() const override { return sizeof(gpu::SlabMember); } // of the nodes' bins
    Extras extras() const override { return kAllExtras; }
    bool draws(std::string_view model) const override {
        return model == kSumMedium || model == kEllipsoidMedium || model == kVolumeMedium;
    }
    bool hasClosedForms() const override { return false; }
    // None where the nodes of the medium do not fit, as for `grid`.
    void addWays(const PlanScene& scene, const RenderSettings& way, bool asked, std::vector<RenderSettings>& ways,
                 std::string& refused) const override {
        if (!asked) return;
        const std::string why = gridRefusal(scene.extent, way);
        if (why.empty())
            ways.push_back(way);
        else
            refused = std::string(name()) + ": " + why;
    }
    // Half as far between rays and between slices.
    RenderSettings finer(const RenderSettings& settings) const override {
        RenderSettings fine = settings;
        fine.froxels.pixels = std::max(settings.froxels.pixels / 2, 1u);
        fine.froxels.slices = std::min(2 * settings.froxels.slices, uint32_t(limits::kSlices.hi));
        return fine;
    }
};

} // namespace brume
