// One submission: the light of a tick once, then every eye's picture. Owns the passes and the scratch that they share.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <vector>

#include "common/camera.h"
#include "server/light/opaque_shadow.h"
#include "server/light/particle_light.h"
#include "server/light/shadow_volume.h"
#include "server/render/background.h"
#include "server/render/compose.h"
#include "server/render/depth_order.h"
#include "server/render/drawn_cells.h"
#include "server/render/merged_media.h"
#include "server/render/method.h"
#include "server/render/picture.h"
#include "server/sim/simulation.h"

namespace brume {

struct EyeRequest {
    Pose pose;
    uint32_t width = 0, height = 0;
    bool second = false; // of one head's two eyes: the first is the request before it
    uint32_t rate = 0;   // instead of RenderSettings::rate, of methods that march; 0: that
};

// What one submission writes and reads on the CPU's side. Several may be alive: one on the device, others being encoded.
class Submission {
public:
    Submission(const gpu::Device& device, const char* name) : commands(device, name) {}

    // The pictures, one per eye in the order asked for. Precondition: commands.wait() was true.
    std::span<const PictureView> pictures();

    gpu::Commands commands;

private:
    friend class Renderer;
    gpu::Buffer particles_, uniforms_, planes_;
    std::vector<PictureView> pictures_;
};

class Renderer {
public:
    // Of radiance and transmittance while they accumulate. 16 bits would not do: T near 1 rounds by 2.4e-4 there, so that a layer
    // of optical depth 2e-4 changes nothing, and ten thousand of those are T = 0.14.
    static constexpr VkFormat kRadianceFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

    // For at most `capacity` particles. `besides`: for measurements, what shaders are compiled for though the scene has none of
    // it. Throws gpu::Error.
    Renderer(const gpu::Device& device, const Scene& scene, uint32_t capacity, const SceneFeatures& besides = {});
    ~Renderer();

    // Records and submits everything for `eyes` at the simulation's present state.
    // Precondition: no other submission of this renderer is on the device.
    // `settings`: instead of the simulation's, whose method may be a choice that is still open. `full`: pictures of R, G, B.
    void submit(Submission& submission, const Simulation& simulation, std::span<const EyeRequest> eyes,
                const RenderSettings* settings = nullptr, bool full = false);

    // Bytes of the CPU's memory that lists of particles take here.
    uint64_t particleBytes() const;

    // For measurements: the next submission uploads and lights everything, also what rests since the last one.
    void forget() { particles_then_.clear(); }

    // For tests and measurements: the float radiance (RGB) and transmittance (A) of the last eye, read back slowly. What
    // keepRadiance(true) was called for before the submission; methods that need no such picture are slower then.
    void keepRadiance(bool keep) { compose_.keepRadiance(keep); }
    std::vector<glm::vec4> readRadiance();

private:
    void fitBuffers(Submission& submission, const Simulation& simulation, std::span<const EyeRequest> eyes, bool full);
    void fitParticles(Submission& submission, std::span<const gpu::Particle> particles, std::span<const EyeRequest> eyes);
    struct Targets {
        gpu::Image radiance, view_depth;
    };
    void fitTargets(VkCommandBuffer cmd, Targets& targets, std::span<const EyeRequest> eyes) const;
    Method& method(const SceneNow& now);
    void recordParticleLight(Submission& submission, const gpu::Resource& tick_block);
    uint32_t drawingStep(const Method& method) const;
    // Whether only the medium is drawn at every step_-th pixel, and what is behind it at all.
    bool drawsCells() const { return step_ > 1 && features_.opaque; }
    void gatherInputs(Submission& submission, const SceneNow& now, std::span<const EyeRequest> eyes);

    const gpu::Device& device_;
    const Scene scene_;
    const uint32_t capacity_;
    const std::vector<gpu::Opaque> objects_;
    ShadowVolume shadow_volume_;
    OpaqueShadow opaque_shadow_;
    ParticleLight particle_light_;
    Background background_;
    DepthOrder depth_order_;
    const SceneFeatures features_; // but for the lobe, which commands turn on and off
    Compose compose_;
    DrawnCells cells_;
    std::vector<gpu::View> views_;  // one per eye
    std::vector<EyeRequest> drawn_; // what is drawn of it: all of its pixels, or every step_-th
    uint32_t step_ = 1;
    std::vector<EyeInputs> inputs_, nodes_;
    gpu::Sampler linear_, nearest_;
    gpu::Buffer particles_, objects_buffer_, planes_;
    Targets targets_, node_targets_;
    std::map<std::string, std::unique_ptr<Method>> methods_; // by their settings
    VkExtent2D last_size_{};
    SceneNow now_; // of this submission
    gpu::Tick tick_{};
    std::vector<gpu::Particle> particles_now_, particles_then_; // of this submission; of the last one, on the device
    bool moved_ = true;                                         // whether they differ
    uint64_t particle_version_ = 0;                             // as EyeInputs
    MediumExtent extent_;
    SpatialOrder order_;
    std::vector<gpu::Particle> ordered_; // as the device has them, where they are many
    MergedMedia merged_;
};

} // namespace brume
