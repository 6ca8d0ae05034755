#include "server/opaque/surfaces.h"

#include <algorithm>

#include "server/inputs/constants.h"
#include "server/inputs/multiple_block.h"
#include "shaders/background_comp.h"
#include "shaders/background_frag.h"
#include "shaders/background_vert.h"
#include "shaders/object_bins_comp.h"

namespace brume {
namespace {

constexpr VkDeviceSize kOrderBytes = gpu::kMostBodies * sizeof(uint32_t);

uint32_t binsOf(uint32_t width, uint32_t height) {
    return gpu::groups(width, gpu::kObjectBin) * gpu::groups(height, gpu::kObjectBin);
}

gpu::Variants programOf(const gpu::Device& device, bool by_draw) {
    if (!by_draw) return {device, background_comp, "background"};
    return {device,
            {{VK_SHADER_STAGE_VERTEX_BIT, background_vert, "background"},
             {VK_SHADER_STAGE_FRAGMENT_BIT, background_frag, "background"}},
            {.formats = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_SFLOAT}, .blend = gpu::Blend::replace}};
}

} // namespace

Surfaces::Surfaces(const gpu::Device& device, const ObjectCounts& objects, bool meshes, bool by_draw)
    : device_(device), first_(objects), meshes_(meshes), by_draw_(by_draw),
      bins_program_(device, object_bins_comp, "object_bins"), program_(programOf(device, by_draw)) {
    prepare({}, objects, {});
}

bool Surfaces::isMany() const {
    return objects_.bodies() > gpu::kFewObjects || objects_.boxes != first_.boxes || objects_.spheres != first_.spheres;
}

void Surfaces::prepare(std::span<const EyeRequest> eyes, const ObjectCounts& objects,
                       std::span<const gpu::Opaque> all) {
    objects_ = objects;
    const uint32_t words = gpu::groups(isMany() ? objects.bodies() : 0, 32), of_words = gpu::groups(words, 32);
    VkDeviceSize bytes = 256;
    for (const EyeRequest& eye : eyes)
        bytes = std::max(bytes, VkDeviceSize(binsOf(eye.width, eye.height)) * (words + of_words) * sizeof(uint32_t));
    bins_.atLeast(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "object bins");
    order_.atLeast(device_, std::max<size_t>(isMany() ? eyes.size() : 0, 1) * kOrderBytes,
                   VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload, "order of objects");
    if (isMany()) writeOrder(eyes, all);
}

// By bodyBegin() of shaders/lib/object_bins.glsl.
void Surfaces::writeOrder(std::span<const EyeRequest> eyes, std::span<const gpu::Opaque> all) {
    for (size_t eye = 0; eye < eyes.size(); ++eye) {
        const glm::vec3 forward = eyes[eye].pose.orientation * glm::vec3(0, 0, -1);
        nearest_.clear();
        for (uint32_t i = 0; i < all.size(); ++i) {
            if (all[i].kind == gpu::kPlane) continue;
            const float reach = all[i].kind == gpu::kBox ? glm::length(all[i].half_size) : all[i].half_size.x;
            nearest_.emplace_back(glm::dot(all[i].centre - eyes[eye].pose.position, forward) - reach, i);
        }
        std::ranges::sort(nearest_);
        const std::span<uint32_t> order = order_.mapped<uint32_t>(nearest_.size(), eye * kOrderBytes);
        std::ranges::transform(nearest_, order.begin(), [](const auto& one) { return one.second; });
    }
    order_.flush();
}

gpu::Resource Surfaces::orderOf(const EyeInputs& in) const {
    return gpu::storageBuffer("ObjectOrder", order_, isMany() ? in.view * kOrderBytes : 0, kOrderBytes);
}

// Ends with its writes visible to all.
void Surfaces::recordBins(gpu::Commands& commands, const EyeInputs& in) {
    const gpu::Commands::Pass pass(commands, "object bins", in.view);
    bins_program_.with().bind(commands, in.resources, {gpu::storageBuffer("ObjectBins", bins_), orderOf(in)});
    vkCmdDispatch(commands.handle(), gpu::groups(binsOf(in.size.width, in.size.height), 64), 1, 1);
    gpu::everythingBefore(commands.handle());
}

void Surfaces::record(gpu::Commands& commands, const EyeInputs& in) {
    const VkCommandBuffer cmd = commands.handle();
    gpu::everythingBefore(cmd); // the eye before has used the same targets
    const bool many = isMany();
    if (many && objects_.bodies() > 0) recordBins(commands, in);
    const gpu::Commands::Pass pass(commands, "opaque", in.view);
    const gpu::Resource own[] = {
        gpu::storageBuffer("ObjectBins", bins_), orderOf(in),
        gpu::storageBuffer("Particles", *in.shared->particles)}; // all particles, also for eyes with fewer
    const auto compiled = [&](uint32_t count) { return many ? std::min(count, 1u) : count; };
    const gpu::Program& program =
        program_.with(constantsOf(in.shared->features),
                      {{gpu::kIdPlanes, objects_.planes},
                       {gpu::kIdBoxes, compiled(objects_.boxes)},
                       {gpu::kIdSpheres, compiled(objects_.spheres)},
                       {gpu::kIdManyObjects, many},
                       {gpu::kIdHasStructure, objects_.structure},
                       {gpu::kIdHasMeshes, meshes_},
                       {gpu::kIdMediumGlow, lightsSurfaces(*in.shared->tick, in.shared->settings->propagation)}});
    if (by_draw_) {
        gpu::beginDrawing(cmd, in.size, {&in.target->radiance, &in.target->view_depth});
        program.bind(commands, in.resources, own, {});
        vkCmdDraw(cmd, 3, 1, 0, 0);
        vkCmdEndRendering(cmd);
    } else {
        program.bind(commands, in.resources, own, {});
        vkCmdDispatch(cmd, gpu::groups(in.size.width, 8), gpu::groups(in.size.height, 8), 1);
    }
    gpu::everythingBefore(cmd);
}

} // namespace brume
