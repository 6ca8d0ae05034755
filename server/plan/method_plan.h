// MethodPlan: what the plan knows about a medium method. It names the method's passes and their costs, lists the ways
// to render (settings), and predicts the work and the error of each. No device, no shader. Each method defines one in
// server/methods/NAME/NAME_plan.cpp.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/plan/cost_model.h"
#include "server/plan/work.h"

namespace brume {

// How overload makes a method coarser: fewer samples along each ray; rays farther apart; light that is sharp at pixels.
enum class Coarser { along, across, light };

// What only some methods draw.
struct Extras {
    bool fog = false;
    bool local_lights = false;
    bool meshes = false;
};
inline constexpr Extras kAllExtras{true, true, true};

class MethodPlan {
public:
    virtual ~MethodPlan() = default;
    virtual const char* name() const = 0;
    virtual const char* about() const = 0; // one line: the algorithm, and which support of the particles it renders

    // Empty if it can render with these settings; otherwise one line: what is wrong, what is allowed.
    virtual std::string refusal(const RenderSettings& /*settings*/) const { return {}; }
    // A number that differs between settings for which its shaders are compiled differently.
    virtual uint32_t variant(const RenderSettings& /*settings*/) const { return 0; }
    // The same, with the shaders that one made method chooses from, and those of passes that it alone asks for. Those
    // that differ by settings.rate have one number. It is taken from what the method's programs are found by.
    virtual uint32_t shaders(const RenderSettings& settings) const = 0;
    // The settings in a few words, for people.
    virtual std::string text(const RenderSettings& /*settings*/) const { return name(); }
    // Bytes of device memory per particle, in addition to what all methods share.
    virtual uint64_t bytesPerParticle() const { return 0; }

    // --- for `auto`. A method that does not override the following functions is used when a scene names it; `auto`
    // never chooses it.

    // The costs of its passes, in the order of display. Several methods may name the same cost.
    virtual std::span<const CostInfo* const> costs() const { return {}; }
    // Appends all ways to render the scene: copies of `way` in which every setting left open (0) has a value.
    // `asked`: true if the scene names this method. `refused` gets one line if the scene allows none of the ways, or
    // not the coarsest.
    virtual void addWays(const PlanScene& /*scene*/, const RenderSettings& way, bool asked,
                         std::vector<RenderSettings>& ways, std::string& /*refused*/) const {
        if (asked) ways.push_back(way);
    }
    // Adds its work: once per tick for all viewers, and for one view. Precondition: no setting is left open.
    virtual void addSharedWork(const PlanScene& /*scene*/, const RenderSettings& /*settings*/, Work& /*work*/) const {}
    virtual void addViewWork(const ViewWork& /*view*/, const RenderSettings& /*settings*/, Work& /*work*/) const {}
    // Predicted relative RMSE of a view of the medium, without the error of the volumetric shadow map: a law of the
    // scene, the view and the settings. Nothing: the method has no such law.
    virtual std::optional<double> error(const RenderSettings& /*settings*/, const ViewWork& /*view*/) const {
        return {};
    }
    // What it draws of fog, local lights and meshes.
    virtual Extras extras() const { return {}; }
    // True: it draws media of this Medium::model.
    virtual bool draws(std::string_view model) const { return model == kSumMedium; }
    // True: it draws light that scatters more than once (RenderSettings::scattering).
    virtual bool drawsMultiple() const { return false; }
    // True: it traces rays that are settings.rate pixels apart, and every view may have its own rate.
    virtual bool hasRays() const { return false; }
    // True: what it draws along a ray follows closed forms. False: it samples cells and is as exact as these are small.
    virtual bool hasClosedForms() const { return true; }
    // The next coarser settings in a direction; nothing if there are none.
    virtual std::optional<RenderSettings> coarser(const RenderSettings& /*settings*/, Coarser /*direction*/) const {
        return {};
    }
    // Settings with a fraction of the error, for still pictures.
    virtual RenderSettings finer(const RenderSettings& settings) const { return settings; }
};

// Why a scene with fog, local lights or meshes is not for a method, one line; empty: it is.
inline std::string extrasRefusal(const MethodPlan& method, const SceneFeatures& features) {
    const Extras drawn = method.extras();
    if (features.fog <= drawn.fog && features.local_lights <= drawn.local_lights && features.meshes <= drawn.meshes)
        return {};
    const char* lacks =
        drawn.local_lights ? "no fog and no meshes" : "no fog, no meshes, and no light of points and spots";
    return std::string(method.name()) + ": it draws " + lacks + "; use slabs, grid, froxels, lit, gradients or march";
}

// Why a scene's medium is not for a method, one line; empty: it is.
inline std::string mediumRefusal(const MethodPlan& method, const SceneFeatures& features) {
    const auto [model, others] = features.balls        ? std::pair(kUnionMedium, "sprites or tiles")
                                 : features.tetrahedra ? std::pair(kTetrahedraMedium, "tetrahedra")
                                 : features.volume     ? std::pair(kVolumeMedium, "grid, froxels, lit or march")
                                 : features.ellipsoids ? std::pair(kEllipsoidMedium, "slabs, grid or tiles")
                                                       : std::pair(kSumMedium, "slabs or grid");
    if (method.draws(model)) return {};
    return std::string(method.name()) + ": it draws no medium.model = \"" + model + "\"; use " + others;
}

// Why scattering as the settings ask for is not for a method, one line; empty: it is.
inline std::string scatteringRefusal(const MethodPlan& method, const RenderSettings& settings) {
    if (settings.scattering == "single" || method.drawsMultiple()) return {};
    return std::string(method.name()) + ": it draws light that scatters once; use slabs or grid, or "
                                        "render.scattering = \"single\"";
}

} // namespace brume
