// One thing to measure: a scene with its settings, seen by some viewers at once, rendered again and again.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/image.h"
#include "server/plan/planner.h"
#include "server/render/renderer.h"

namespace brume::bench {

struct Case {
    std::string scene = "cloud";    // a shipped scene's name, or a path
    std::vector<std::string> set;   // key=value, instead of the scene's
    std::string camera = "outside"; // see poseOf()
    glm::uvec2 size{640, 360};
    uint32_t viewers = 1;       // around the target, evenly
    SceneFeatures besides = {}; // that shaders are compiled for though the scene has none of it
};

// The scene with the case's settings. Throws SceneError, also for a method that does not exist.
Scene sceneOf(const Case& wanted);

// outside: the scene's own camera. inside: the same way, from the middle of the medium's bounds. 20m: the same way, 20 m from the
// target. x,y,z or x,y,z:x,y,z: from there, to the scene's target or to that place. Throws std::runtime_error for anything else.
Pose poseOf(const std::string& camera, const Scene& scene, const Simulation& simulation);

// The pose carried about a vertical axis through `target`, radians.
Pose turnedAbout(const Pose& pose, glm::vec3 target, float angle);

// "640x360". Throws std::runtime_error.
glm::uvec2 sizeOf(const std::string& text);

// What one frame took: ms of each pass, the views' together, in the order of recording; whether it is shared by all views.
struct FrameCost {
    struct Pass {
        std::string name;
        bool shared;
        double ms;
    };
    std::vector<Pass> passes;
    double wall_ms = 0; // from recording to done
    uint64_t fragments = 0;
};

class Stage {
public:
    // Steps the simulation by `ticks` first. Method auto: as planned with `costs`.
    Stage(const gpu::Device& device, const Case& wanted, uint32_t ticks = 0, const CostModel& costs = builtInCosts());

    FrameCost frame();                                        // all viewers of the case
    RadianceImage picture(const Pose& pose, glm::uvec2 size); // one more view, read back
    std::span<const PictureView> planes();                    // of the last frame, as JPEG takes them

    const Plan& plan() const { return plan_; }
    const Scene& scene() const { return scene_; }
    const Simulation& simulation() const { return simulation_; }
    const Pose& pose() const { return eyes_.front().pose; } // of the first viewer
    uint64_t deviceBytes() const { return device_bytes_; }  // held by this stage after its first frame
    uint64_t particleBytes() const { return simulation_.bytes() + renderer_.particleBytes(); } // on the CPU
    std::vector<gpu::Particle> particles() const;

private:
    void submit(std::span<const EyeRequest> eyes);

    const gpu::Device& device_;
    uint64_t bytes_before_;
    Scene scene_;
    Simulation simulation_;
    Renderer renderer_;
    Submission submission_;
    Plan plan_;
    std::vector<EyeRequest> eyes_;
    uint64_t device_bytes_ = 0;
};

// Nearest rank; 0 of nothing.
double percentile(std::vector<double> values, double part);
inline double median(const std::vector<double>& values) { return percentile(values, 0.5); }

} // namespace brume::bench
