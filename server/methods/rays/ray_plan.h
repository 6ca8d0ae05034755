// The plan of methods that integrate the medium along a coarse grid of rays cut into slabs (slab_rays.h): their
// settings `rate` and `slabs`, their errors, and what it costs to show the rays' field.
#pragma once

#include "server/plan/method_plan.h"
#include "shaders/shared/field.h"

namespace brume {

namespace costs {
// Pixels of a medium on a grid of rays, where all are shaded, x (1, 1 more with objects, 1 more for each caster).
inline constexpr CostInfo kComposeField{"compose_field", "compose", 11};
inline constexpr CostInfo kRayEnds{"ray_ends", "ray ends", 1.6}; // pixels, in scenes with objects
inline constexpr CostInfo kShade{"shade", "shade", 170};         // shaded pixels, where not all are
inline constexpr CostInfo kPresent{"present", "present", 3.4};   // pixels, then
} // namespace costs

// Rays before a picture's first pixel: one that cubic interpolation needs, two that the spline's coefficients need.
inline constexpr uint32_t kRayMargin = 3;
// Rays of a row or column that are not the first of a cell of the picture, where there are `margin` before it.
constexpr uint32_t raysBeyond(uint32_t margin) { return 2 * margin + 1; }

// Errors that these approximations leave (relative RMSE), as measured against the double-precision reference:
// docs/results/data/plan.md. The constants are upper bounds of what was measured at 640x360 on cloud, cloud-5000, tubes
// and props from outside and from within, each cause by itself.
//
// Of rays `spacing` projected standard deviations apart: a cubic B-spline errs by the fourth derivative, which of
// Gaussians grows on with every order; between spacings of a half and two that is the power 4.5.
double rayError(double spacing);
// Of slabs `thickness` standard deviations thick; `depth`: mean optical depth of a deviation's length; `inside`: the
// eye is in the medium.
double slabError(double thickness, double depth, bool inside);

class RayPlan : public MethodPlan {
public:
    bool hasRays() const override { return true; }
    std::optional<double> error(const RenderSettings& settings, const ViewWork& view) const override;
    std::optional<RenderSettings> coarser(const RenderSettings& settings, Coarser direction) const override;
    // Half as far between rays and between slabs.
    RenderSettings finer(const RenderSettings& settings) const override;

protected:
    // What a method errs beside its rays and slabs, relative RMSE.
    virtual double nodeError(const RenderSettings& /*settings*/) const { return 0; }
    // Appends `way` with every number of rays and slabs that it leaves open.
    static void addRays(RenderSettings way, std::vector<RenderSettings>& ways);
    // Surfaces behind the medium, and from the field to pixels.
    static void addDisplayWork(const ViewWork& view, const RenderSettings& settings, Work& work);
    // Columns and rows of a view's rays.
    static glm::dvec2 raysOf(const ViewWork& view, const RenderSettings& settings);
    // 1.2 where casters ask for faces of most slabs; else 1.
    static double facesKept(const ViewWork& view) { return view.scene().features.casters ? 1.2 : 1; }
    static double quantitiesOf(const PlanScene& scene) { return gpu::mediumQuantities(scene.extent.one_albedo); }
};

} // namespace brume
