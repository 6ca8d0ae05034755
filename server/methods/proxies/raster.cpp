#include "server/methods/proxies/raster.h"

#include <optional>
#include <utility>

#include "server/inputs/constants.h"
#include "server/methods/proxies/furthest_depths.h"

namespace brume {
namespace {

class Raster : public Method {
public:
    Raster(const MethodContext& context, RasterInfo info)
        : device_(context.device), order_(context.depth_order), info_(std::move(info)),
          program_(device_, info_.shaders, {.topology = info_.topology}) {
        const SceneFeatures& f = context.features;
        for (const bool may_be_cut : {false, true})
            if (may_be_cut || !f.opaque) program(f, may_be_cut);
        if (f.opaque) furthest_.emplace(device_);
        mesh_ = info_.shaders.front().stage == VK_SHADER_STAGE_MESH_BIT_EXT;
    }

    MethodNeeds needs() const override { return info_.needs; }

    std::span<const ViewGroup> prepare(std::span<const EyeInputs> eyes) override {
        if (furthest_) furthest_->prepare(eyes);
        return Method::prepare(eyes);
    }

    void recordGroup(gpu::Commands& commands, const ViewGroup& group) override {
        const EyeInputs& in = *group.any;
        const VkCommandBuffer cmd = commands.handle();
        order_.record(commands, in, info_.support, info_.vertices, info_.particles_per_group,
                      furthest_ ? &*furthest_ : nullptr);

        const gpu::Commands::Pass pass(commands, "medium", in.view);
        gpu::beginDrawing(cmd, in.size, {&in.target->radiance});
        const gpu::Resource own[] = {
            gpu::storageBuffer("Order", order_.order()), gpu::storageBuffer("Arguments", order_.arguments()),
            info_.maps ? gpu::storageBuffer("Maps", info_.maps) : in.resources.storage("Particles").as("Maps")};
        const glm::vec2 push = info_.push ? info_.push(*in.shared) : glm::vec2(0);
        program(in.shared->features, furthest_ || in.near_plane_cuts)
            .bind(commands, in.resources, own, std::as_bytes(std::span(&push, info_.push ? 1 : 0)));
        if (mesh_)
            device_.drawMeshTasksIndirect(cmd, order_.arguments().handle(), offsetof(gpu::DrawArguments, groups_x), 1,
                                          0);
        else
            vkCmdDrawIndirect(cmd, order_.arguments().handle(), 0, 1, 0);
        vkCmdEndRendering(cmd);
        gpu::drawToCompute(cmd); // within the pass: a software driver draws when it must, and its time counts here
    }

private:
    // `may_be_cut`: true if an interval may be cut inside a particle.
    const gpu::Program& program(const SceneFeatures& features, bool may_be_cut) {
        gpu::Constants own(info_.constants.begin(), info_.constants.end());
        own.push_back({gpu::kIdMayBeCut, may_be_cut});
        return program_.with(constantsOf(features), own);
    }

    const gpu::Device& device_;
    DepthOrder& order_;
    RasterInfo info_;
    std::optional<FurthestDepths> furthest_; // with objects
    gpu::Variants program_;
    bool mesh_ = false;
};

} // namespace

std::unique_ptr<Method> makeRaster(const MethodContext& context, RasterInfo info) {
    return std::make_unique<Raster>(context, std::move(info));
}

} // namespace brume
