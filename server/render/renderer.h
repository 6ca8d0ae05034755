// Renderer: records and submits all passes of one submission. Particles are uploaded and lit once; then every eye's
// picture is drawn. It owns the passes and the images that eyes share.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "server/effects/effect.h"
#include "server/encode/picture.h"
#include "server/inputs/tetrahedra_buffers.h"
#include "server/inputs/volume_buffers.h"
#include "server/methods/method.h"
#include "server/methods/plans.h"
#include "server/methods/proxies/depth_order.h"
#include "server/opaque/mesh_buffers.h"
#include "server/opaque/object_buffers.h"
#include "server/opaque/surfaces.h"
#include "server/render/compose.h"
#include "server/render/depth_layers.h"
#include "server/render/drawn_cells.h"
#include "server/render/probe.h"
#include "server/render/targets.h"
#include "server/render/tick_upload.h"
#include "shaders/shared/particle_fit.h"

namespace brume {

// What one submission writes and reads on the CPU's side. Several may be alive: one on the device, others being
// encoded.
class Submission {
public:
    Submission(const gpu::Device& device, const char* name) : commands(device, name) {}

    // The pictures, one per eye in the order asked for. Precondition: commands.wait() was true.
    std::span<const PictureView> pictures() {
        planes_.invalidate();
        return pictures_;
    }
    // The layers with depth of each; without any of an eye that asked for none. Precondition as for pictures(), which
    // comes first.
    std::span<const DepthLayersView> layers() const { return layers_; }
    uint64_t pictureBytes() const { return planes_.size(); }
    // The light on particles that Renderer::submitLight() was asked for: those of the first hue, then of the next one.
    // Precondition: commands.wait() was true.
    struct Fits {
        std::vector<gpu::Particle> particles; // in the simulation's order
        std::vector<Hue> hues;
        std::vector<std::span<const gpu::ParticleFit>> fits; // of each hue, a fit for each particle
        std::vector<gpu::Opaque> objects;
        gpu::Tick tick{};
    };
    const Fits& fits() {
        if (fits_bytes_) fits_bytes_.invalidate();
        return fits_;
    }
    // Frees the memory of the pictures. Precondition: nobody reads them, and it is not on the device.
    void giveBack() {
        pictures_.clear();
        layers_.clear();
        planes_ = {};
    }

    gpu::Commands commands;
    ProbeReading probe; // pixels to read back with the next pictures; none: it costs nothing

private:
    friend class Renderer;
    gpu::Buffer particles_, uniforms_, planes_;
    std::vector<PictureView> pictures_;
    std::vector<DepthLayersView> layers_;
    gpu::Buffer groups_, fits_bytes_;
    Fits fits_;
};

class Renderer {
public:
    // `capacity`: the most particles there can be. `besides`: features compiled into shaders although the scene lacks
    // them, for measurements. Throws gpu::Error.
    Renderer(const gpu::Device& device, const Scene& scene, uint32_t capacity, const SceneFeatures& besides = {});
    ~Renderer();

    // Records and submits everything for `eyes` at the simulation's present state, and does not wait for the device:
    // submission.commands.wait() does.
    // `settings`: resolved settings of the plan. Null: the simulation's, whose method must then not be "auto".
    // `full`: true for planes R, G, B; false for planes Y, Cb, Cr with half as many chroma samples each way. Pictures
    // of several hues are full, whatever is asked for.
    // Precondition: no other submission of this renderer is on the device.
    // Throws gpu::Error, for example when pictures do not fit the device's memory. Then destroy this renderer.
    void submit(Submission& submission, const Simulation& simulation, std::span<const EyeRequest> eyes,
                const RenderSettings* settings = nullptr, bool full = false);

    // The same for the light on particles, and no picture. `groups`: particles to be lit in place of all; empty: all
    // are. Precondition: there are groups, or fewer than kLargeMedium particles.
    void submitLight(Submission& submission, const Simulation& simulation, const RenderSettings& settings,
                     std::span<const gpu::Particle> groups = {});

    // From the next submission on: of the scene's lists only what shaders with these features draw.
    void drawOnly(const SceneFeatures& lists) { lists_ = lists; }

    // Bytes of all pictures of one submission, at most: what the device lets a shader see of one buffer.
    static uint64_t mostPictureBytes(const gpu::Device& device) {
        return device.properties().limits.maxStorageBufferRange;
    }
    // Bytes of the CPU's memory that lists of particles take here.
    uint64_t particleBytes() const { return upload_.cpuBytes(); }
    // Bytes on the device whose number depends on the pictures' sizes, without the methods' fields and a submission's
    // own.
    uint64_t pictureBytes() const;
    // Bytes of a pixel of the largest picture, besides its planes: its target, a coarse target with a quarter of the
    // pixels, a shaded node of eight bytes for a quarter of them, and light that is kept for each pixel.
    static uint64_t mostBytesOfPixel(const SceneFeatures& features);
    // Bytes of pictureBytes() that pictures of `eyes` need at least, however they are drawn. `full` as for submit().
    static uint64_t pictureBytes(std::span<const EyeRequest> eyes, bool full, const SceneFeatures& features);
    // Frees the memory of pictures and of methods; pipelines stay. Precondition: nothing is on the device.
    void giveBack();
    // What methods' shaders have counted until the present submission began.
    const LightWork& lightWork() const { return light_work_; }
    // The same until now. Precondition: nothing is on the device.
    const LightWork& countLightWork();
    // Methods that are kept on the device, with their programs and buffers.
    size_t methodsKept() const { return methods_.size(); }

    // For measurements: the next submission uploads and lights the medium again, even if nothing has changed.
    void forget();

    // For tests that go through many methods: keeps up to `most` compiled, at least 1, instead of two.
    void keepMethods(size_t most) { most_methods_ = most; }

    // The float radiance (RGB) and transmittance (A) of the last eye, read back slowly.
    // Needs keepRadiance(true) before the submission; methods with a field are slower then.
    void keepRadiance(bool keep) { compose_.keepRadiance(keep); }
    std::vector<glm::vec4> readRadiance();
    // Likewise the view depths (m) of the surfaces in front of the sky; empty where no surface is drawn.
    std::vector<float> readDepths();

private:
    Method& methodFor(const RenderSettings& settings);
    uint32_t drawingStep(const MethodNeeds& needs) const;
    bool hasMedium() { return !upload_.all().empty() || features_.fog; }
    // True: surfaces are drawn at every pixel and the medium at every step_-th, with what lies between interpolated.
    bool drawsCoarsely() const { return step_ > 1 && features_.opaque; }
    void placePictures(Submission& submission, std::span<const EyeRequest> eyes, bool full);
    void takeLayers(Submission& submission, std::span<const ViewGroup> groups, std::span<const EyeRequest> eyes) const;
    void begin(const Simulation& simulation, const RenderSettings* settings);
    EffectInputs effectInputs(const Simulation& simulation, std::span<const EyeRequest> eyes, const MethodNeeds& needs);
    void gatherTick();
    void gatherEyes(const UniformBlocks& blocks, std::span<const EyeRequest> eyes);
    std::span<const ViewGroup> groupsOf(Method& method);
    bool needsSurfaces(const ViewGroup& group, const EyeInputs* before) const;
    void recordGroup(Submission& submission, Method& method, const ViewGroup& group, const EyeInputs* before);
    void recordFieldAndCompose(gpu::Commands& commands, const ViewGroup& group);
    void recordLayers(gpu::Commands& commands, Method& method, const ViewGroup& group);
    void enterHue(uint32_t hue);
    void keepHue(gpu::Commands& commands, const ViewGroup& group, uint32_t hue);
    std::vector<glm::vec4> readDrawn(VkExtent2D size);
    void recordCoarsely(gpu::Commands& commands, Method& method, const EyeInputs& eye);
    void recordReadBack(Submission& submission);

    const gpu::Device& device_;
    const Scene scene_;
    ObjectBuffers objects_;
    const MeshBuffers meshes_;
    std::optional<SceneFeatures> lists_; // draws(); nothing: everything in the scene's lists is drawn
    const SceneFeatures besides_;        // that shaders are compiled for, though the scene may lack them
    TickUpload upload_;
    std::optional<TetrahedraBuffers> tetrahedra_; // of a medium of them
    std::optional<VolumeBuffers> volume_;         // of a medium that is one
    const Effects effects_;
    Surfaces surfaces_;
    DepthOrder depth_order_;
    Compose compose_;
    Probe probe_;
    DrawnCells cells_;
    DepthLayers depth_layers_;
    gpu::Sampler nearest_;
    gpu::Buffer planes_, fits_, groups_;
    VkDeviceSize planes_bytes_ = 0; // of the present submission
    Targets targets_, coarse_targets_;

    // A method, and the settings that it was compiled for.
    struct Made {
        const MethodPlan* plan = nullptr;
        uint32_t variant = 0;
        SceneFeatures features;
        std::unique_ptr<Method> method;
    };
    std::vector<Made> methods_; // the newest first
    size_t most_methods_ = 2;
    LightWork light_work_;

    // Of the present submission.
    SceneNow now_;
    uint64_t tick_number_ = 0;
    SceneFeatures features_;
    std::vector<Hue> hues_;
    uint32_t step_ = 1;             // one pixel is drawn for step_ x step_ of the finished pictures
    std::vector<EyeRequest> drawn_; // the pixels that are drawn: all, or every step_-th
    std::vector<gpu::View> views_;  // the finished pictures
    TickInputs shared_;
    std::vector<EyeInputs> inputs_;        // one per eye
    std::vector<EyeInputs> coarse_inputs_; // the same eyes at every step_-th pixel, if drawsCoarsely()
    std::vector<ViewGroup> no_medium_;     // one per eye, for a scene with neither particles nor fog
    VkExtent2D last_size_{};               // of the last eye's finished picture
    std::vector<gpu::Buffer> kept_;        // with several hues and keepRadiance(): vec4[], radiance of each
};

} // namespace brume
