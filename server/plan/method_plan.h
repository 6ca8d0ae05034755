// What the plan must know of a medium method: its passes and their costs, the ways in which it can render, how much work each way
// is and how large its error. No device, no shader. Each method defines one in server/methods/NAME/NAME_plan.cpp.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/plan/cost_model.h"
#include "server/plan/work.h"

namespace brume {

// In which direction overload makes a method coarser.
enum class Coarser { along, across }; // fewer samples along each ray; rays farther apart

class MethodPlan {
public:
    virtual ~MethodPlan() = default;
    virtual const char* name() const = 0;
    virtual const char* about() const = 0; // one line: what it is, which support of the particles it renders

    // The quadratures that it can choose from, its own first; empty: it has but one.
    virtual std::span<const char* const> quadratures() const { return {}; }
    // The one that the settings ask for, or its own first one where it lacks that; empty when it has no choice.
    std::string_view quadratureOf(const RenderSettings& settings) const {
        for (const char* own : quadratures())
            if (settings.quadrature == own) return own;
        return quadratures().empty() ? std::string_view() : quadratures().front();
    }
    // Empty if it can render with these settings; otherwise one line: what is wrong, what is allowed.
    virtual std::string refusal(const RenderSettings& /*settings*/) const { return {}; }
    // Differs between settings that its shaders are compiled for differently.
    virtual uint32_t variant(const RenderSettings& /*settings*/) const { return 0; }
    // A way in a few words, for people.
    virtual std::string text(const RenderSettings& /*settings*/) const { return name(); }
    // Bytes of the device's memory for each particle, beside those that all methods share.
    virtual uint64_t bytesPerParticle() const { return 0; }

    // --- for the choice. A method that leaves out what follows is used where it is asked for, and never chosen by `auto`.

    // The costs of its passes, in the order in which people see them; those that methods share may be named by each.
    virtual std::span<const CostInfo* const> costs() const { return {}; }
    // Appends all ways to render the scene: `way` with every setting that it leaves open. `asked`: the scene asks for this method
    // by name. `refused` becomes one line when the scene allows none of them, or not the coarsest.
    virtual void addWays(const PlanScene& /*scene*/, const RenderSettings& way, bool asked, std::vector<RenderSettings>& ways,
                         std::string& /*refused*/) const {
        if (asked) ways.push_back(way);
    }
    // Adds its work once per tick for everybody, and for one view. Precondition: every setting is chosen.
    virtual void addSharedWork(const PlanScene& /*scene*/, const RenderSettings& /*settings*/, Work& /*work*/) const {}
    virtual void addViewWork(const ViewWork& /*view*/, const RenderSettings& /*settings*/, Work& /*work*/) const {}
    // Relative RMSE of a view of the medium, but for that of the light's map. 1: not known.
    virtual double error(const RenderSettings& /*settings*/, const ViewWork& /*view*/) const { return 1; }
    // True: settings.rate is the distance of its rays, and every view may have its own.
    virtual bool hasRays() const { return false; }
    // The next coarser settings in that direction; nothing when there are none.
    virtual std::optional<RenderSettings> coarser(const RenderSettings& /*settings*/, Coarser /*direction*/) const { return {}; }
    // With a fraction of the error, for pictures that rest.
    virtual RenderSettings finer(const RenderSettings& settings) const { return settings; }
};

} // namespace brume
