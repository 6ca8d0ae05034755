// How much work each pass has with a way to render, counted from a sample of the particles: no device, no shader.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/camera.h"
#include "common/scene.h"
#include "server/light/medium_extent.h"
#include "server/light/shadow_resolution.h"
#include "server/plan/cost_model.h"
#include "server/render/method.h"
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
};

inline constexpr float kCoarsestShadow = 0.05f, kFinestShadow = 2e-4f; // of them

// Units as Cost says; of the passes that a frame does not have: 0.
using Work = std::array<double, kCosts>;

// Once per tick, for everyone: of the volumetric shadow map, and of all the rest.
Work shadowWork(const PlanScene& scene, const PlanScene::Shadow& shadow);
Work sharedWork(const PlanScene& scene, const RenderSettings& settings);

// Whether a way integrates along a grid of rays cut into slabs: its settings have a rate and slabs.
inline bool marches(const RenderSettings& settings) { return settings.method == "slabs" || settings.method == "grid"; }

// Pixels that the medium's standard deviation has in a picture, in the middle of the view depths between which the medium lies.
double projectedDeviation(const MediumExtent& extent, const PlanView& view);

// A view with the sample's places in it, for many settings.
class ViewWork {
public:
    ViewWork(const PlanScene& scene, const PlanView& view);

    // Precondition: where marches(settings), settings.rate and settings.slabs are not 0.
    Work of(const RenderSettings& settings) const;

    bool inside() const { return near_ <= kNear; }         // the eye is in the medium's bounds
    bool sees() const { return far_ > near_; }             // some of the medium is before the eye
    double raySpacing(uint32_t rate) const;                // of neighbouring rays, in projected standard deviations
    double deviation() const { return 1 / raySpacing(1); } // projectedDeviation()
    double slabThickness(uint32_t slabs) const;            // in standard deviations
    double deviationDepth() const;                         // mean optical depth of a standard deviation's length

    static constexpr double kNear = 0.05; // m, as the renderer's near plane

private:
    struct Seen {                        // what is in the picture of a particle: the box around it
        double left, right, top, bottom; // pixels, clipped
        double near, far;                // m of view depth
    };
    double fragments(double radius_factor) const;

    const PlanScene& scene_;
    uint32_t width_, height_;
    double pixel_;      // m per m of view depth
    double near_, far_; // m, view depths between which the medium lies
    double weight_;     // particles per one of the sample
    std::vector<Seen> seen_;
};

} // namespace brume
