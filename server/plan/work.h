// Work: how many units each pass has to process, counted from a sample of the particles. Every method's plan uses it.
// No device, no shader.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/camera.h"
#include "common/scene.h"
#include "server/inputs/tick_block.h"
#include "server/medium/extent.h"
#include "server/medium/shadow_resolution.h"
#include "server/plan/cost_model.h"
#include "server/plan/medium_sample.h"
#include "server/plan/seen_light.h"
#include "shaders/shared/types.h"

namespace brume {

// One picture to plan for.
struct PlanView {
    Pose pose;
    uint32_t width = 0, height = 0; // pixels
    uint32_t viewer = 0;            // whose picture, for Corrections; 0: nobody's
    double weight = 1;              // pictures like it that cost as much, itself too
};

// Objects beyond these are thought to lie elsewhere than a pixel's ray: bins leave them out.
inline constexpr uint32_t kMostCounted = 12;

// The scene as the plan sees it. Its size does not grow with the particle count.
struct PlanScene {
    RenderSettings wanted; // settings of the scene and of commands; method may be kAutoMethod
    SceneFeatures features;
    double lobe_width = 1; // rad, PhaseLobes::width()
    uint32_t objects = 0;  // objects that a pixel may meet, by and large: kMostCounted at most
    // Boxes and spheres as balls with the same mean outline, evenly chosen; each stands for caster_weight of them.
    struct Ball {
        glm::vec3 centre{0};
        float radius = 0; // m
    };
    std::vector<Ball> caster_balls;
    double caster_weight = 1;
    uint32_t triangles = 0;                    // triangles of meshes that cast shadows: kMostCounted at most
    std::vector<gpu::LocalLight> local_lights; // points and spots
    std::vector<Glass> glasses;                // sheets of glass
    gpu::Tick tick{};                          // light, falloff, cut, bounds of the shadow volume
    // Times that a view's passes run for one picture (server/inputs/hues.h).
    uint32_t hues = 1;
    uint32_t particles = 0, capacity = 0; // now, and at most
    std::vector<gpu::Particle> sample;    // evenly chosen; each stands for weight() particles
    MediumSample medium_sample;
    MediumExtent extent;
    // Possible resolutions of the volumetric shadow map: errors from kFinestShadow to kCoarsestShadow,
    // wanted.shadow_error times powers of two. Those coarser than wanted are for overload.
    struct Shadow {
        float wanted = 0; // the shadow_error that this resolution is for
        ShadowResolution resolution;
    };
    std::vector<Shadow> shadows;
    uint64_t state = 0; // a hash of what the passes read that run once per tick
    // Part of the frames for which what is once per tick is done. Less than 1: the medium rests, and passes whose input
    // is as before are not run again.
    double renewed = 1;

    // Particles that one of the sample stands for.
    double weight() const { return sample.empty() ? 0 : double(particles) / double(sample.size()); }
    double support(const gpu::Particle& particle) const; // m, radius beyond which it is cut
    bool needsRays() const { return brume::needsRays(tick); }
};

inline constexpr float kCoarsestShadow = 0.05f, kFinestShadow = 2e-4f; // relative errors, ends of PlanScene::shadows

// Units of work for every pass; CostInfo names the unit. 0 for passes that a frame does not have.
class Work {
public:
    double& operator[](const CostInfo& cost) { return units_[numberOf(cost)]; }
    double operator[](const CostInfo& cost) const { return units_[numberOf(cost)]; }
    double operator[](size_t number) const { return units_[number]; }
    Work& operator+=(const Work& other);
    Work& operator*=(double times);
    double ms(const CostModel& model) const;

private:
    std::array<double, kMostCosts> units_{};
};

// Work once per tick for all viewers, without that of the volumetric shadow map: shadowWork() has it
// (effects/shadow_volume/shadow_volume_plan.h).
Work sharedWork(const PlanScene& scene, const RenderSettings& settings);

// True: the eye is in the medium's bounds.
bool isInside(const MediumExtent& extent, glm::vec3 eye);

// The medium's standard deviation in pixels of a picture, at the middle of the view depths that the medium covers.
double projectedDeviation(const MediumExtent& extent, const PlanView& view);

// One view with the sample's particles projected into it; used to count the work of many settings.
class ViewWork {
public:
    ViewWork(const PlanScene& scene, const PlanView& view);

    // Work of this view with the settings' method. Precondition: no setting is left open.
    Work of(const RenderSettings& settings) const;

    const PlanScene& scene() const { return scene_; }
    const PlanView& view() const { return view_; }
    glm::vec3 eye() const { return view_.pose.position; }
    uint32_t width() const { return width_; } // pixels
    uint32_t height() const { return height_; }
    double pixels() const { return double(width_) * height_; }
    double pixel() const { return pixel_; } // width of a pixel, m per m of view depth
    double near() const { return near_; }   // m of view depth: where the medium in front of the eye begins, ends
    double far() const { return far_; }
    // True: along the view axis the medium's bounds begin at the near plane or before it. isInside() is of the bounds.
    bool inside() const;
    bool sees() const { return far_ > near_; } // True: some particles may be in front of the eye
    // True: there is something to err at, particles or fog that rays are sampled for.
    bool errs() const { return sees() || (scene_.features.fog && scene_.needsRays()); }
    double raySpacing(uint32_t rate) const;                // between neighbours, in projected standard deviations
    double deviation() const { return 1 / raySpacing(1); } // projectedDeviation()
    double slabThickness(uint32_t slabs) const;            // in standard deviations
    double viewDepth(glm::vec3 x) const;                   // m
    const SeenLight& light() const;                        // found when first asked for: work alone does not need it
    // Pixels in the ranges of points and spots, one for every light that reaches it.
    double litPixels() const { return lit_pixels_; }
    std::span<const double> litPixelsOf() const { return lit_pixels_of_; } // by local light
    double mediumPixels() const { return medium_pixels_; }                 // of the box around the medium
    // Shadows of objects that a pixel's ray meets in the medium, on the mean.
    double shadowsMet() const;
    // Pixels covered by all particles, if each covers `part_of_box` of the box around it.
    double fragments(double part_of_box) const;

    struct Seen {                        // box around one of the sample's particles in the picture
        double left, right, top, bottom; // pixels, clipped
        double near, far;                // m of view depth
        double pixels() const { return std::max(right - left, 0.0) * std::max(bottom - top, 0.0); }
    };
    std::span<const Seen> seen() const { return seen_; }

private:
    const PlanScene& scene_;
    PlanView view_;
    uint32_t width_, height_;
    double pixel_, near_, far_, lit_pixels_ = 0, medium_pixels_ = 0;
    std::vector<double> lit_pixels_of_;
    std::vector<Seen> seen_;
    mutable std::optional<SeenLight> light_;
};

// Number of cells that [lo, hi] touches, in a row of `count` cells of `size` from 0.
double cellsTouched(double lo, double hi, double size, double count);
// Number of groups of `size` that cover `count` items.
double groupsOf(uint32_t count, uint32_t size);
// Tetrahedra that a ray meets, of a mesh that fills a cube: it has some five for each corner, and of n a ray meets
// about 2 n^(1/3).
double tetrahedraOnRay(uint32_t corners);

} // namespace brume
