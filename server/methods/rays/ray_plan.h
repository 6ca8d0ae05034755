// The plan of methods that integrate the medium along a coarse grid of rays cut into slabs (slab_rays.h): their
// settings `rate` and `slabs`, their errors, and what it costs to show the rays' field.
#pragma once

#include "server/inputs/multiple_block.h"
#include "server/plan/method_plan.h"
#include "shaders/shared/field.h"

namespace brume {

namespace costs {
// Pixels of a medium on a grid of rays, where all are shaded, x (1, 1 more with objects, 1 more for each caster).
inline constexpr CostInfo kComposeField{"compose_field", "compose", 8.5};
inline constexpr CostInfo kRayEnds{"ray_ends", "ray ends", 1.6}; // pixels, in scenes with objects
inline constexpr CostInfo kShade{"shade", "shade", 170};         // shaded pixels, where not all are
inline constexpr CostInfo kPresent{"present", "present", 3.4};   // pixels, then
} // namespace costs

// Where nothing reads what rays hold (needsRays()). Their field's memory is passed over all the same, and pixels of a
// tile of rays share a list of casters. From 4 on pictures take as long, with one they take 1.2 to 3.7 times as long.
inline constexpr uint32_t kUnreadRate = 8, kUnreadSlabs = 8;

// RenderSettings::lamp_spacing: as long as accuracy is kept, and under overload.
inline constexpr float kFineLamps = 0.25f, kCoarseLamps = 1;

// Rays before a picture's first pixel: one that cubic interpolation needs, two that the spline's coefficients need.
inline constexpr uint32_t kRayMargin = 3;
// Rays of a row or column that are not the first of a cell of the picture, where there are `margin` before it.
constexpr uint32_t raysBeyond(uint32_t margin) { return 2 * margin + 1; }

// Errors that these approximations leave in a view, relative RMSE. Particles err independently of each other: the sum
// of SeenLight's sizes, by their parts. docs/models.md has the laws of one size and where they come from.
double raysError(const ViewWork& view, uint32_t rate);
double slabsError(const ViewWork& view, uint32_t slabs, bool widened = true); // widened: True: particles are

// Of particles of one size. `spacing`: of rays, in projected standard deviations.
double rayError(double spacing);
// Of the edges of fogs, between rays that are `rate` pixels apart: fogs with a ball or heights where they end.
double fogError(const ViewWork& view, uint32_t rate);
// Of lamps whose light rays hold, and of soft edges.
double lightingError(const ViewWork& view, const RenderSettings& settings);
// `thickness`: of slabs, in standard deviations. `bend`: depth of a deviation's length and more (SeenLight::bendOf).
// `light_depth`: SeenLight::lightDepth().
double slabError(double thickness, double bend, double light_depth);
// Of slabs thicker than 1.43 deviations: particles are widened along the view axis, which is not the ray. `oblique`: as
// SeenLight::Size.
double widenedError(double thickness, double oblique);
// The same particles are displaced on average, all alike: what lies behind is lit more or less. thickness, deviation in
// m; extinction: of the whole medium there, 1/m.
double displacedError(double thickness, double deviation, double extinction);
// Some of their mass is beyond the first and the last slab.
double endsError(double thickness, uint32_t slabs);
// Of slabs that sample a Gaussian at their middles. `thickness`: along the ray, in deviations that it has there. A ray
// off the view axis crosses more of a particle's width between two middles.
double sampledError(double thickness);
// Of particles that the near plane cuts.
double cutError(double thickness, double light_depth);

class RayPlan : public MethodPlan {
public:
    bool hasRays() const override { return true; }
    Extras extras() const override { return kAllExtras; }
    bool drawsMultiple() const override { return true; }
    bool draws(std::string_view model) const override { return model == kSumMedium || model == kEllipsoidMedium; }
    uint32_t shaders(const RenderSettings& settings) const override { return scatteringShaders(settings); }
    std::optional<double> error(const RenderSettings& settings, const ViewWork& view) const override;
    std::optional<RenderSettings> coarser(const RenderSettings& settings, Coarser direction) const override;
    // Half as far between rays and between slabs.
    RenderSettings finer(const RenderSettings& settings) const override;

protected:
    // Rays, slabs and how sharp light is, in a few words.
    static std::string raysText(const RenderSettings& settings);
    // True: particles that are thinner than slabs are widened. False: they are sampled as they are.
    virtual bool widens() const { return true; }
    // What a method errs beside its rays and slabs, relative RMSE.
    virtual double nodeError(const RenderSettings& /*settings*/, const ViewWork& /*view*/) const { return 0; }
    // Appends `way` with every number of rays and slabs that it leaves open; with one where nothing reads rays.
    static void addRays(const PlanScene& scene, RenderSettings way, std::vector<RenderSettings>& ways);
    // Surfaces behind the medium, and from the field to pixels.
    static void addDisplayWork(const ViewWork& view, const RenderSettings& settings, Work& work);
    // Columns and rows of a view's rays.
    static glm::dvec2 raysOf(const ViewWork& view, const RenderSettings& settings);
    // 1.2 where casters ask for faces of most slabs; else 1.
    static double facesKept(const ViewWork& view) { return view.scene().features.casters ? 1.2 : 1; }
    static double quantitiesOf(const PlanScene& scene) { return gpu::mediumQuantities(scene.extent.one_albedo); }
};

} // namespace brume
