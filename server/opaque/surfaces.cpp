#include "server/opaque/surfaces.h"

#include <algorithm>

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

} // namespace

Surfaces::Surfaces(const gpu::Device& device, const ObjectCounts& objects, bool meshes, bool by_draw)
    : device_(device), first_(objects), meshes_{gpu::kIdHasMeshes, meshes}, by_draw_(by_draw) {
    prepare({}, objects, {});
}

bool Surfaces::isMany() const {
    return objects_.bodies() > gpu::kFewObjects || objects_.boxes != first_.boxes || objects_.spheres != first_.spheres;
}

const Surfaces::Programs& Surfaces::programsFor(const Variant& variant) {
    Programs& made = programs_[variant];
    const gpu::SpecConstant planes{gpu::kIdPlanes, variant.objects.planes}, boxes{gpu::kIdBoxes, variant.objects.boxes},
        spheres{gpu::kIdSpheres, variant.objects.spheres}, many{gpu::kIdManyObjects, variant.many},
        structure{gpu::kIdHasStructure, variant.objects.structure}, fog{gpu::kIdHasFog, variant.fog},
        lights{gpu::kIdHasLocalLights, variant.local_lights}, balls{gpu::kIdUnion, variant.balls};
    if (by_draw_ && !made.draw) {
        const gpu::ShaderCode shaders[] = {{VK_SHADER_STAGE_VERTEX_BIT, background_vert, "background"},
                                           {VK_SHADER_STAGE_FRAGMENT_BIT, background_frag, "background"}};
        const gpu::SpecConstant constants[] = {planes, boxes, spheres, many, structure, meshes_, fog, lights, balls};
        gpu::GraphicsInfo graphics;
        graphics.formats = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_SFLOAT};
        graphics.blend = gpu::Blend::replace;
        made.draw = gpu::GraphicsProgram(device_, shaders, graphics, constants);
    }
    if (!by_draw_ && !made.compute)
        made.compute = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, background_comp, "background"},
                                           {planes, boxes, spheres, many, structure, meshes_, fog, lights, balls});
    return made;
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
    if (!bins_program_)
        bins_program_ =
            gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, object_bins_comp, "object_bins"}, {});
    bins_program_.bind(commands, in.resources, {gpu::storageBuffer("ObjectBins", bins_), orderOf(in)});
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
    ObjectCounts compiled = objects_;
    if (many) compiled.boxes = std::min(compiled.boxes, 1u), compiled.spheres = std::min(compiled.spheres, 1u);
    const Programs& programs = programsFor(
        {compiled, many, in.shared->features.fog, in.shared->features.local_lights, in.shared->features.balls});
    if (by_draw_) {
        gpu::beginDrawing(cmd, in.size, {&in.target->radiance, &in.target->view_depth});
        programs.draw.bind(commands, in.resources, own, {});
        vkCmdDraw(cmd, 3, 1, 0, 0);
        vkCmdEndRendering(cmd);
    } else {
        programs.compute.bind(commands, in.resources, own, {});
        vkCmdDispatch(cmd, gpu::groups(in.size.width, 8), gpu::groups(in.size.height, 8), 1);
    }
    gpu::everythingBefore(cmd);
}

} // namespace brume
