// Stage: a scene with settings and some viewers, rendered again and again for measurements.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/image.h"
#include "server/plan/planner.h"
#include "server/render/renderer.h"

namespace brume::bench {

// Where several viewers stand: evenly around the target, unless one of these says otherwise.
struct Stand {
    bool inside = false;  // True: in free places within the scene (standInside()), and not where the camera is
    float apart = 0;      // degrees that each is turned from the one before, all in one place
    float eyes_apart = 0; // m that each is to the right of the one before, all with one direction
};

struct Case {
    std::string scene = "cloud";    // name of a shipped scene, or a path
    std::vector<std::string> set;   // key=value, replaces the scene's value
    std::string camera = "outside"; // see poseOf()
    glm::uvec2 size{640, 360};
    uint32_t viewers = 1;
    Stand stand;
    uint32_t lights = 0;        // the first ones of the scene's lights; 0: all
    SceneFeatures besides = {}; // compiled into shaders though the scene lacks them
};

struct NamedCase {
    std::string name; // of the variant of a series
    Case wanted;
};

// Loads the scene with the case's settings. Throws SceneError, also for an unknown method.
Scene sceneOf(const Case& wanted);

// The pose of a named camera. Throws std::runtime_error for any other name.
// - outside: the scene's own camera.
// - inside: at the middle of the medium's bounds, in the direction of the scene's camera.
// - 20m: 20 m from the target, in the direction of the scene's camera.
// - x,y,z or x,y,z:x,y,z: at that position, toward the scene's target or toward the second position.
Pose poseOf(const std::string& camera, const Scene& scene, const Simulation& simulation);

// The pose rotated by `angle` (rad) about a vertical axis through `target`.
Pose turnedAbout(const Pose& pose, glm::vec3 target, float angle);

// Of all viewers. Throws as poseOf() and standInside() do.
std::vector<Pose> posesOf(const Case& wanted, const Scene& scene, const Simulation& simulation);

// True: neither sky nor ambient light, RadianceImage::medium_alone.
bool isMediumAlone(const Scene& scene);

// Parses a size such as "640x360". Throws std::runtime_error.
glm::uvec2 sizeOf(const std::string& text);

// Times of one frame: ms of each pass, summed over views, in the order of recording.
struct FrameCost {
    struct Pass {
        std::string name;
        bool shared; // True: once for all views
        double ms;
    };
    std::vector<Pass> passes;
    double wall_ms = 0; // from the begin of recording until the device is done
    uint64_t fragments = 0;
    LightWork light; // what methods' shaders counted
};

class Stage {
public:
    // Steps the simulation by `ticks` first. `costs`: for the plan if the method is auto.
    Stage(const gpu::Device& device, const Case& wanted, uint32_t ticks = 0, const CostModel& costs = builtInCosts());

    void step(std::span<const Command> commands) { simulation_.step(commands); }
    FrameCost frame();     // renders all viewers of the case
    FrameCost nextFrame(); // a frame of the next tick, which knows what the last frame has made
    // Rays to voxels of frames with one viewer each, summed over all viewers.
    uint64_t voxelRaysAlone();
    // Renders one more view and reads it back. `history`: as EyeRequest::history.
    RadianceImage picture(const Pose& pose, glm::uvec2 size, uint64_t history = 0);
    // Renders one more view, and says how long its passes took: ms of the device.
    double timed(const Pose& pose, glm::uvec2 size, uint64_t history = 0);
    // Renders one more view: the picture, or what is drawn in its place (shaders/shared/show.h), as a display shows it.
    std::vector<glm::u8vec3> shown(const Pose& pose, glm::uvec2 size, uint32_t show);
    // One more view with `count` layers with depth. Valid until the next picture.
    struct Layered {
        PictureView picture;
        DepthLayersView layers;
        double ms = 0; // of the device
    };
    Layered layered(const Pose& pose, glm::uvec2 size, uint32_t count);
    // The light on the particles, for viewers who draw by themselves. Valid until the next picture.
    const Submission::Fits& fits();
    std::span<const PictureView> planes(); // planes of the last frame, the encoder's input

    double deviceMs(); // of the passes of the last frame or picture
    const Plan& plan() const { return plan_; }
    const Scene& scene() const { return scene_; }
    const Simulation& simulation() const { return simulation_; }
    const Pose& pose() const { return eyes_.front().pose; } // pose of the first viewer
    uint64_t deviceBytes() const { return device_bytes_; }  // held by this stage after its first frame
    uint64_t particleBytes() const { return simulation_.bytes() + renderer_.particleBytes(); } // of CPU memory
    std::vector<gpu::Particle> particles() const;

private:
    void submit(std::span<const EyeRequest> eyes, bool full = false);
    FrameCost costOf(std::span<const EyeRequest> eyes);

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

// Percentile by nearest rank; 0 without values. `part`: 0 ... 1.
double percentile(std::vector<double> values, double part);
// Ranks, from 0, of the two of `count` sorted values between which the true median lies with at least 90 %: by the
// binomial distribution, if values are independent. The first and the last for fewer than five values. `count` >= 1.
std::pair<size_t, size_t> intervalOfMedian(size_t count);
inline double median(const std::vector<double>& values) { return percentile(values, 0.5); }

} // namespace brume::bench
