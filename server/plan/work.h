// How much work the passes have, counted from a sample of the particles: what every method's plan counts with. No device, no
// shader.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/camera.h"
#include "common/scene.h"
#include "server/inputs/scene_features.h"
#include "server/light/shadow_resolution.h"
#include "server/medium/extent.h"
#include "server/plan/cost_model.h"
#include "shaders/shared/types.h"

namespace brume {

// One picture that is wanted.
struct PlanView {
    Pose pose;
    uint32_t width = 0, height = 0; // pixels
};

// The scene as the plan sees it: it does not grow with the particle count.
struct PlanScene {
    RenderSettings wanted; // what the scene and the commands ask for; method may be kAutoMethod
    SceneFeatures features;
    uint32_t objects = 0, casters = 0;
    gpu::Tick tick{}; // light, falloff, cut, bounds of the shadow volume
    uint32_t particles = 0;
    std::vector<gpu::Particle> sample; // evenly chosen, each stands for particles / sample.size()
    MediumExtent extent;
    double extinction = 0; // 1/m, that the medium meets on average, by its optical mass
    // Resolutions of the volumetric shadow map, errors from wanted.shadow_error by halves and doubles: coarser ones are for
    // overload.
    struct Shadow {
        float wanted = 0; // shadow_error that leads to it
        ShadowResolution resolution;
    };
    std::vector<Shadow> shadows;

    double weight() const { return sample.empty() ? 0 : double(particles) / double(sample.size()); } // particles per sample
    double support(const gpu::Particle& particle) const;                                             // m, radius
};

inline constexpr float kCoarsestShadow = 0.05f, kFinestShadow = 2e-4f; // of PlanScene::shadows

// Units as each CostInfo says, by numberOf(); 0 for passes that a frame does not have.
class Work {
public:
    double& operator[](const CostInfo& cost) { return units_[numberOf(cost)]; }
    double operator[](const CostInfo& cost) const { return units_[numberOf(cost)]; }
    double operator[](size_t number) const { return units_[number]; }
    Work& operator+=(const Work& other);
    double ms(const CostModel& model) const;

private:
    std::array<double, kMostCosts> units_{};
};

// Once per tick, for everyone: of the volumetric shadow map, and of all the rest.
Work shadowWork(const PlanScene& scene, const PlanScene::Shadow& shadow);
Work sharedWork(const PlanScene& scene, const RenderSettings& settings);

// Pixels that the medium's standard deviation has in a picture, in the middle of the view depths between which the medium lies.
double projectedDeviation(const MediumExtent& extent, const PlanView& view);

// A view with the sample's places in it, for many settings.
class ViewWork {
public:
    ViewWork(const PlanScene& scene, const PlanView& view);

    // Of the settings' method. Precondition: every setting is chosen.
    Work of(const RenderSettings& settings) const;

    const PlanScene& scene() const { return scene_; }
    uint32_t width() const { return width_; } // pixels
    uint32_t height() const { return height_; }
    double pixels() const { return double(width_) * height_; }
    double pixel() const { return pixel_; } // m per m of view depth
    double near() const { return near_; }   // m of view depth, where the medium begins and ends before the eye
    double far() const { return far_; }
    bool inside() const;                                   // True: the eye is in the medium's bounds
    bool sees() const { return far_ > near_; }             // True: some of the medium is before the eye
    double raySpacing(uint32_t rate) const;                // of neighbouring rays, in projected standard deviations
    double deviation() const { return 1 / raySpacing(1); } // projectedDeviation()
    double slabThickness(uint32_t slabs) const;            // in standard deviations
    double deviationDepth() const;                         // mean optical depth of a standard deviation's length
    // Pixels that particles cover, where each covers this part of the box around it.
    double fragments(double part_of_box) const;

    struct Seen {                        // the box around one of the sample's particles in the picture
        double left, right, top, bottom; // pixels, clipped
        double near, far;                // m of view depth
    };
    std::span<const Seen> seen() const { return seen_; }

private:
    const PlanScene& scene_;
    uint32_t width_, height_;
    double pixel_, near_, far_;
    std::vector<Seen> seen_;
};

// Cells of `size` that [lo, hi] touches, of `count` from 0.
double cellsTouched(double lo, double hi, double size, double count);
// Groups of `size` that cover `count`.
double groupsOf(uint32_t count, uint32_t size);

} // namespace brume
