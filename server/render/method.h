// The interface of a medium method: how the particles of a tick become radiance in one eye's picture.
// A new method is one file in methods/, its shaders and one line in methods.cpp.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/camera.h"
#include "common/scene.h"
#include "server/gpu/commands.h"
#include "server/gpu/program.h"
#include "server/light/medium_extent.h"
#include "shaders/shared/types.h"

namespace brume {

class Background;
class Compose;
class DrawnCells;

// What a method may read for one eye, and the target that holds the background and receives the medium.
struct EyeInputs {
    uint32_t view = 0;                           // its number in the submission, for the pass names
    VkExtent2D size{};                           // pixels that are drawn; the images may be larger
    uint32_t step = 1;                           // of the picture's own between those (Renderer::drawingStep)
    uint32_t particle_count = 0;                 // live ones
    uint64_t particle_version = 0;               // another one whenever the particles, or what the tick says of them, changed
    bool eye_in_medium = true;                   // the near plane may cut particles
    gpu::Resource tick, eye;                     // uniform blocks, bindings 0 and 1
    gpu::Resource other;                         // the block of the head's other eye, binding 6; its own where there is none
    bool ordered = false;                        // that other one has been sorted for already, and so has this one
    const gpu::View* block = nullptr;            // with the eye, where the picture's bytes go, and all its rows
    gpu::Resource view_block;                    // the same, a storage buffer, binding 1
    const gpu::Buffer* particles = nullptr;      // gpu::Particle[particle_count]
    const gpu::Buffer* objects = nullptr;        // gpu::Opaque[gpu::kMostObjects], also as a uniform block
    uint32_t first_caster = 0;                   // of them: ground planes come first
    const gpu::Buffer* particle_light = nullptr; // gpu::ParticleLight[particle_count], for methods that read it
    const gpu::Image* shadow_volume = nullptr;   // light depth
    const gpu::Image* opaque_shadow = nullptr;   // light-space height of the topmost caster
    const gpu::Image* view_depth = nullptr;      // of the nearest opaque surface
    const gpu::Image* radiance = nullptr;        // RGBA32F: radiance, transmittance of the medium in front
    const MediumExtent* extent = nullptr;        // of all particles
    const RenderSettings* settings = nullptr;
    uint32_t rate = 0; // pixels between rays, for methods that march; 0: from the band limit
    Pose pose;
    bool lobe = true;                    // anisotropy > 0
    float asymmetry = 0;                 // of the phase function's lobe
    const gpu::Buffer* planes = nullptr; // where the pictures' bytes go, each as PlaneLayout
    const Background* background = nullptr;
    Compose* compose = nullptr;
    const EyeInputs* nodes = nullptr; // at every step-th pixel: where the medium is drawn first (Renderer::drawsCells)
    DrawnCells* cells = nullptr;
    const gpu::Sampler* linear = nullptr;
    const gpu::Sampler* nearest = nullptr;
};

// What is compiled out of a method's shaders when the scene has none of it.
struct SceneFeatures {
    bool opaque = false, casters = false, lobe = false, ambient = false;
    bool operator==(const SceneFeatures&) const = default;
    SceneFeatures operator|(const SceneFeatures& o) const {
        return {opaque || o.opaque, casters || o.casters, lobe || o.lobe, ambient || o.ambient};
    }
};

class DepthOrder; // far-to-near order of what an eye can see

class Method {
public:
    virtual ~Method() = default;
    // Called before the eyes of one submission are recorded, with those that record() gets, when nothing of the method is on the
    // device: the place for buffers that must grow.
    virtual void prepare(std::span<const EyeInputs> /*eyes*/) {}
    // Records what all eyes of one submission share, before any of them: `any` is one of them, and there are particles. Ends with
    // its writes visible to compute.
    virtual void recordShared(gpu::Commands& /*commands*/, const EyeInputs& /*any*/) {}
    // Whether that is where it reads the particles.
    virtual bool sharesMedium() const { return false; }
    // Records all pictures of one submission, from background to planes. Of methods that do not say otherwise: one eye after the
    // other, the medium drawn over the background.
    virtual void record(gpu::Commands& commands, std::span<const EyeInputs> eyes);
    // Whether EyeInputs::particle_light has to be there.
    virtual bool readsParticleLight() const { return false; }
    // Whether it draws its medium into EyeInputs::radiance, and may be given fewer pixels than the picture's.
    virtual bool draws() const { return true; }

protected:
    // Records the medium over the background. The target and the depth have been written by compute passes; afterwards compute
    // passes read the target: the method's last barrier makes its writes seen there.
    virtual void recordMedium(gpu::Commands& /*commands*/, const EyeInputs& /*in*/) {}
};

struct MethodContext {
    const gpu::Device& device;
    DepthOrder& depth_order;
    RenderSettings settings;
    SceneFeatures features;
};

struct MethodInfo {
    const char* name;
    const char* about;                        // one line: what it is, which support it renders
    std::span<const char* const> quadratures; // that it can choose from, its own first; empty: it has but one
    std::unique_ptr<Method> (*make)(const MethodContext&);
};

// All methods there are, and all quadratures of them.
std::span<const MethodInfo> methods();
std::span<const char* const> quadratures();

// The quadrature that the settings' method uses: the chosen one, its own first where it lacks that; "" where it has no choice.
std::string_view quadratureOf(const RenderSettings& settings);

// Null text when the settings are usable; else what is wrong and what is allowed, in one line.
std::string checkSettings(const RenderSettings& settings);

// Precondition: checkSettings() is content.
std::unique_ptr<Method> makeMethod(const MethodContext& context);

} // namespace brume
