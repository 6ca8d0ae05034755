#include "server/methods/froxels/froxel_volume.h"

#include <algorithm>
#include <cmath>

#include "common/scene_limits.h"
#include "server/gpu/binding_sizes.h"
#include "server/inputs/constants.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/world_box.h"
#include "shaders/froxel_apply_comp.h"

namespace brume {
namespace {

constexpr float kMostGrowth = 16; // thickness of the last slice over that of the first
constexpr double kSeenDepth = 6;  // optical depth of fog behind which slices end
constexpr double kFarthest = 1e4; // m

// Columns of rays, or rows, for so many pixels: one more than cells.
uint32_t raysFor(uint32_t pixels, uint32_t apart) { return gpu::groups(pixels, apart) + 1; }

VkDeviceSize bytesOf(uint32_t columns, uint32_t rows, uint32_t slices) {
    return VkDeviceSize(columns) * rows * (slices + 1) * sizeof(glm::vec4);
}

// Rows of rays in a band.
uint32_t bandRows(VkExtent2D size, const gpu::FroxelGrid& froxels) {
    const uint32_t all = raysFor(size.height, froxels.pixels), columns = raysFor(size.width, froxels.pixels);
    const VkDeviceSize fit = gpu::kLargestBinding / bytesOf(columns, 1, froxels.slices);
    return std::min(all, uint32_t(std::max<VkDeviceSize>(fit, 2)));
}

// Where the medium ends before an eye, m of view depth.
double farOf(const EyeInputs& in) {
    const TickInputs& shared = *in.shared;
    Bounds3 box = worldBox(shared, *in.medium);
    box.add(lampBox(shared, kSeenAround));
    double far = 0;
    if (box.lo.x <= box.hi.x) {
        const glm::dvec3 eye = in.pose.position, out = glm::max(glm::abs(eye - box.lo), glm::abs(eye - box.hi));
        far = glm::length(out);
    } else {
        for (uint32_t i = 0; i < shared.tick->fog_count; ++i)
            far = std::max(far, kSeenDepth / std::max(double(shared.tick->fogs[i].sigma_t), 1e-9));
    }
    return std::min(far, kFarthest);
}

} // namespace

DepthRange mediumRange(const EyeInputs& in) {
    if (in.shared->features.fog) return {kNearDepth, std::max(float(farOf(in)), kNearDepth)};
    const glm::vec3 forward = in.pose.orientation * glm::vec3(0, 0, -1);
    const DepthRange range = depthRange(*in.medium->extent, in.pose.position, forward);
    return {std::max(range.near, kNearDepth), range.far};
}

gpu::FroxelGrid froxelSlices(const EyeInputs& in) {
    const FroxelSettings& settings = in.shared->settings->froxels;
    gpu::FroxelGrid froxels{};
    froxels.pixels = settings.pixels;
    froxels.slices = settings.slices;
    froxels.particles = in.medium->count > 0;
    const DepthRange range = mediumRange(in);
    froxels.near = range.near;
    while (froxels.slices > limits::kSlices.lo &&
           bytesOf(raysFor(in.size.width, froxels.pixels), 2, froxels.slices) > gpu::kLargestBinding)
        froxels.slices /= 2;                                     // of a picture so wide that two rows do not fit
    const float far = std::max(range.far, froxels.near + 1e-2f); // all of it behind the eye: slices without medium
    const float growth = std::clamp(far / froxels.near, 1.01f, kMostGrowth);
    froxels.growth = std::log2(growth) / float(froxels.slices);
    froxels.unit = (far - froxels.near) / (growth - 1);
    return froxels;
}

FroxelVolume::FroxelVolume(const MethodContext& context)
    : device_(context.device), features_(context.features), apply_(context.device, froxel_apply_comp, "froxel_apply") {
    if (features_.opaque) furthest_.emplace(device_);
}

const gpu::Buffer& FroxelVolume::furthest() const { return furthest_ ? furthest_->buffer() : volume_; }

std::span<const ViewGroup> FroxelVolume::prepare(std::span<const EyeInputs> eyes) {
    VkDeviceSize bytes = 0;
    for (const EyeInputs& in : eyes) {
        const gpu::FroxelGrid froxels = froxelSlices(in);
        bytes = std::max(bytes,
                         bytesOf(raysFor(in.size.width, froxels.pixels), bandRows(in.size, froxels), froxels.slices));
    }
    volume_.atLeast(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "froxels");
    if (furthest_) furthest_->prepare(eyes);
    return Method::prepare(eyes);
}

void FroxelVolume::recordGroup(gpu::Commands& commands, const ViewGroup& group) {
    const EyeInputs& in = *group.any;
    const VkCommandBuffer cmd = commands.handle();
    gpu::everythingBefore(cmd); // the eye before has used the same buffers
    gpu::FroxelGrid froxels = froxelSlices(in);
    const uint32_t all = raysFor(in.size.height, froxels.pixels), most = bandRows(in.size, froxels);
    const bool has_rays = in.is_layer && all <= most; // True: the volume holds them
    if (furthest_ && !in.is_layer) furthest_->record(commands, in);
    froxels.rays.x = raysFor(in.size.width, froxels.pixels);
    for (uint32_t row = 0; row + 1 < all; row += most - 1) {
        froxels.first_row = row;
        froxels.rays.y = std::min(most, all - row);
        if (row > 0) gpu::computeToCompute(cmd); // the band before is drawn
        if (!has_rays) recordRays(commands, in, froxels);
        const gpu::Commands::Pass pass(commands, "froxels to pixels", in.view);
        const struct {
            gpu::FroxelGrid froxels;
            glm::uvec2 rows;
        } push{froxels, {row * froxels.pixels, std::min((row + froxels.rays.y - 1) * froxels.pixels, in.size.height)}};
        apply_.with(constantsOf(in.shared->features))
            .bind(commands, in.resources, {gpu::storageBuffer("Volume", volume_)}, push);
        vkCmdDispatch(cmd, gpu::groups(in.size.width, 16), gpu::groups(push.rows.y - push.rows.x, 4), 1);
        gpu::computeToCompute(cmd);
    }
}

} // namespace brume
