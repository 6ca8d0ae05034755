// Method: the half of a medium method that runs on the device. MethodPlan (server/plan/method_plan.h) is the other
// half: what it costs and how far it errs. A new method is a folder beside this file, its shaders and one line in
// list.h (docs/extending.md).
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "server/gpu/commands.h"
#include "server/inputs/method_needs.h"
#include "server/inputs/scene_features.h"
#include "server/inputs/view_group.h"

namespace brume {

// Numbers that shaders have counted, of methods that count.
struct LightWork {
    uint64_t voxel_rays = 0;  // shadow rays from the voxels that viewers share
    uint64_t froxel_rays = 0; // shadow rays from the froxels of shadow frusta
    uint64_t places = 0;      // places where light was computed
    uint64_t samples = 0;     // the places between which light is interpolated
    uint64_t nodes = 0;       // nodes of the medium where light was computed, since no sample reaches them
    uint64_t holes = 0;       // nodes of the medium that have no light

    bool operator==(const LightWork&) const = default;
    bool any() const { return *this != LightWork(); }
    LightWork operator+(const LightWork& o) const {
        return {voxel_rays + o.voxel_rays, froxel_rays + o.froxel_rays,
                places + o.places,         samples + o.samples,
                nodes + o.nodes,           holes + o.holes};
    }
    LightWork operator-(const LightWork& o) const {
        return {voxel_rays - o.voxel_rays, froxel_rays - o.froxel_rays,
                places - o.places,         samples - o.samples,
                nodes - o.nodes,           holes - o.holes};
    }
};

class Method {
public:
    virtual ~Method() = default;
    virtual MethodNeeds needs() const { return {}; }
    // Of submissions that are done, since the last call of this.
    virtual LightWork workSince() { return {}; }

    // Grows buffers for a submission's eyes and returns its groups in the order of drawing. Called once per submission,
    // before recordTick(), while nothing of the method is on the device. Precondition: there are eyes, and particles or
    // fog. The result is valid until the next call.
    virtual std::span<const ViewGroup> prepare(std::span<const EyeInputs> eyes) {
        drawnOneByOne(eyes, groups_);
        return groups_;
    }
    // Records what all eyes of the submission share. `medium`: the first eye's list, which with MethodNeeds::one_medium
    // is everyone's. Ends with its writes visible to compute.
    virtual void recordTick(gpu::Commands& /*commands*/, const TickInputs& /*tick*/, const MediumView& /*medium*/) {}
    // Records the medium of one group: into its target, over the background that compute passes have written there, or
    // into its field. The group comes from prepare(); with MethodNeeds::writes_target it may also be a coarse picture
    // of one eye, or the same again up to sheets of glass (EyeInputs::is_layer). Ends with its writes visible to
    // compute.
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
    std::filesystem::path sprite_maps; // Medium::sprite_maps
    bool same_particles = true;        // True: particle i is the same one in all ticks
};

// Throws gpu::Error for an unknown name; its text lists the known ones. Precondition: checkSettings() is empty
// (plans.h).
std::unique_ptr<Method> makeMethod(const MethodContext& context);

} // namespace brume
