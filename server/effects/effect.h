// Effect: the half of a kind of light, or of a surface in the medium, that runs on the device. EffectPlan
// (effect_plan.h) is the other half: what it costs. A new effect is a folder beside this file, its shaders and one line
// in list.h (docs/extending.md).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/gpu/commands.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/method_needs.h"
#include "server/inputs/view_group.h"
#include "server/sim/simulation.h"

namespace brume {

// What a submission is made of, besides TickInputs. All of it is valid until the submission is on its way.
struct EffectInputs {
    const Simulation& simulation;
    const SceneNow& now;
    std::span<const EyeRequest> eyes;         // the pictures that are asked for
    std::span<const gpu::Opaque> objects;     // planes, boxes, spheres
    std::span<const gpu::Particle> particles; // all that there are now
    const MediumExtent& extent;               // bounds and more of all particles
    MethodNeeds needs;                        // what the method reads that draws
    uint32_t hues = 1;                        // number of hues that the pictures have (hues.h)
    bool moved = true;                        // True: the particles are not those of the last submission
    MediumView& all;                          // all particles; its resources are there when recording begins
    std::span<MediumView* const> seen;        // lists of particles that eyes see, each once
    // Where the light on the particles of `fitted` goes, gpu::ParticleFit[], those of each hue `fits_stride` bytes
    // after those of the one before. Null: nobody asks for it.
    const gpu::Buffer* fits = nullptr;
    const MediumView* fitted = nullptr;
    VkDeviceSize fits_stride = 0;
};

// Effects are asked in the order of list.h, and give what others and methods read of them to TickInputs. Nothing of an
// effect is on the device when prepare() is called; from then on only recording follows. What a recording function has
// written is visible to compute when it returns; of recordTick() and recordHue() also to draws.
class Effect {
public:
    virtual ~Effect() = default;

    // Makes room for a submission. At the end of recordTick() TickInputs has a resource for every name that a shader
    // declares of this effect, whether or not it is read.
    virtual void prepare(const EffectInputs& /*in*/, TickInputs& /*tick*/) {}
    // Records what all eyes and hues share.
    virtual void recordTick(gpu::Commands& /*commands*/, const EffectInputs& /*in*/, TickInputs& /*tick*/) {}
    // Records what all eyes share in the hue of `tick`.
    virtual void recordHue(gpu::Commands& /*commands*/, const EffectInputs& /*in*/, TickInputs& /*tick*/) {}
    // Records what the surfaces of one eye's picture read, before they are drawn.
    virtual void recordEye(gpu::Commands& /*commands*/, const EyeInputs& /*in*/) {}
    // Records what a group's pixels read besides its field, after the medium and before they are composed.
    virtual void recordField(gpu::Commands& /*commands*/, const ViewGroup& /*group*/) {}

    // Layers that a picture is the sum of, besides that of the whole medium. At most one effect has any.
    virtual uint32_t layersOf(const EyeInputs& /*in*/) const { return 0; }
    // Takes from the target what it holds of a layer, and sets it up for the next one. It is called layers + 1 times:
    // with `drawn` 0 after the whole medium, then after each layer. After the last call the target holds the sum.
    virtual void recordLayer(gpu::Commands& /*commands*/, const ViewGroup& /*group*/, uint32_t /*drawn*/,
                             uint32_t /*layers*/) {}

    // Bytes on the device whose number depends on the pictures' sizes.
    virtual uint64_t pictureBytes() const { return 0; }
    // Frees the memory of pictures, and what takes much besides. Precondition: nothing of it is on the device.
    virtual void giveBack() {}
    // Drops what the effect keeps though the medium changes, for measurements.
    virtual void forget() {}
};

struct EffectContext {
    const gpu::Device& device;
    const Scene& scene;
    uint32_t capacity; // the most particles there can be
};

using Effects = std::vector<std::unique_ptr<Effect>>;

// One of every line in list.h.
Effects makeEffects(const EffectContext& context);

} // namespace brume
