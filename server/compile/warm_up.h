// WarmUp: draws pictures that nobody sees, so that their shaders are compiled.
#pragma once

#include "server/plan/planner.h"
#include "server/render/renderer.h"

namespace brume {

class WarmUp {
public:
    // All outlive this. Precondition: nothing is on the device. `probed`: true if the shader that reads pixels back is
    // compiled, too; it takes as long as all others of a picture.
    WarmUp(Renderer& renderer, Submission& submission, const Scene& scene, const Simulation& simulation, bool probed);

    // One picture of the scene's own camera. Waits for the device, as all do here.
    void draw(const RenderSettings& settings, bool still) { draw(own_, settings, still); }
    // With all shaders that cameras choose from: far and near ones, outside and in the medium, with a picture before
    // and without.
    void drawForEveryCamera(const RenderSettings& settings, bool still);

    // One picture with layers with depth.
    void drawLayers(const RenderSettings& settings);
    // One picture of every view of how pictures are made.
    void drawViews(const RenderSettings& settings, bool still);

    const PlanView& own() const { return own_; }
    const PlanView& inside() const { return inside_; } // in the middle of the medium

private:
    // `other`: what is asked for besides a pose and a size.
    void draw(const PlanView& view, const RenderSettings& settings, bool still, EyeRequest other = {});

    Renderer& renderer_;
    Submission& submission_;
    const Simulation& simulation_;
    const PlanView own_;
    PlanView inside_;
    const bool probed_;
    const bool coarse_; // True: distant pixels may be shaded, and what lies between interpolated
};

} // namespace brume
