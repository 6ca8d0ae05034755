// EffectPlan: what the plan knows about an effect: its passes, their work and its memory. No device, no shader. Each
// effect defines one in server/effects/NAME/NAME_plan.cpp.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "server/plan/cost_model.h"
#include "server/plan/work.h"

namespace brume {

class EffectPlan {
public:
    // `costs`: of its passes, in the order of display.
    explicit EffectPlan(std::vector<const CostInfo*> costs = {}) : costs_(std::move(costs)) {}
    virtual ~EffectPlan() = default;

    std::span<const CostInfo* const> costs() const { return costs_; }
    // Adds its work: once per tick for all viewers, and for one view. The method's own work is in `work` already.
    // Precondition: no setting is left open.
    virtual void addSharedWork(const PlanScene& /*scene*/, const RenderSettings& /*settings*/, Work& /*work*/) const {}
    virtual void addViewWork(const ViewWork& /*view*/, const RenderSettings& /*settings*/, Work& /*work*/) const {}

    // Bytes on the device for each pixel of the largest picture: that all pictures need, and at most.
    virtual uint64_t bytesOfPixel(const SceneFeatures& /*features*/) const { return 0; }
    virtual uint64_t mostBytesOfPixel(const SceneFeatures& features) const { return bytesOfPixel(features); }

private:
    const std::vector<const CostInfo*> costs_;
};

// Every effect, in the order of list.h.
std::span<const EffectPlan* const> effectPlans();

} // namespace brume
