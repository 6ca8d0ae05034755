// The interface of a medium method on the device: how the particles of a tick become radiance in pictures.
// A new method is a folder beside this file, its shaders and one line in list.h (docs/extending.md).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/gpu/commands.h"
#include "server/inputs/scene_features.h"
#include "server/inputs/view_group.h"

namespace brume {

// What the renderer prepares for a method, or may do with it.
struct MethodNeeds {
    bool particle_light = false; // True: it reads MediumView::light
    bool one_medium = false;     // True: it reads particles in recordTick() only, so all eyes see the same list of them
    bool draws = true;           // True: it writes RenderTarget::radiance, and may be given every 2nd, 4th or 8th pixel only.
                                 // False: it makes a field that Compose samples
};

class Method {
public:
    virtual ~Method() = default;
    virtual MethodNeeds needs() const { return {}; }

    // Makes room for a submission's eyes and says which views are drawn together, in order. Called while nothing of the method is
    // on the device: the place where buffers may grow. Precondition: there are eyes and particles. Valid until the next call.
    virtual std::span<const ViewGroup> prepare(std::span<const EyeInputs> eyes) {
        drawnOneByOne(eyes, groups_);
        return groups_;
    }
    // Records what all eyes of the submission share. Ends with its writes visible to compute.
    virtual void recordTick(gpu::Commands& /*commands*/, const TickInputs& /*tick*/, const MediumView& /*medium*/) {}
    // Records the medium of one of those groups: into its target, over the background that compute passes have written there, or
    // into its field. Ends with its writes visible to compute.
    virtual void recordGroup(gpu::Commands& commands, const ViewGroup& group) = 0;

protected:
    std::vector<ViewGroup> groups_;
};

class DepthOrder; // far-to-near order of what an eye can see

struct MethodContext {
    const gpu::Device& device;
    DepthOrder& depth_order;
    RenderSettings settings;
    SceneFeatures features;
};

// Throws gpu::Error, naming the methods that there are, for any other. Precondition: checkSettings() is empty (plans.h).
std::unique_ptr<Method> makeMethod(const MethodContext& context);

} // namespace brume
