#include "server/render/targets.h"

#include <algorithm>

namespace brume {
namespace {

// Weights of the values at -1, 0, 1, 2: as in shaders/present.comp.
glm::vec4 cubic(float t) {
    return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
            (t + 1) * t * (t - 1) / 6};
}

constexpr size_t kKept = 64; // targets, before those of a submission are made
constexpr VkImageUsageFlags kUsage =
    VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
constexpr VkImageUsageFlags kCopied = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;

gpu::ImageInfo radianceInfo(VkExtent2D size) { return {kRadianceFormat, size, kUsage | kCopied}; }
gpu::ImageInfo depthInfo(VkExtent2D size) {
    return {VK_FORMAT_R32_SFLOAT, size, kUsage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
}

// Where the images of one target lie in its memory: radiance at the start, view depth behind it.
struct Place {
    VkMemoryRequirements bytes; // of both
    VkDeviceSize depth;         // offset of the view depth
};

Place placeOf(const gpu::Device& device, VkExtent2D size) {
    const VkMemoryRequirements radiance = gpu::Image::needs(device, radianceInfo(size)),
                               depth = gpu::Image::needs(device, depthInfo(size));
    const VkDeviceSize at = (radiance.size + depth.alignment - 1) / depth.alignment * depth.alignment;
    return {{at + depth.size, std::max(radiance.alignment, depth.alignment),
             radiance.memoryTypeBits & depth.memoryTypeBits},
            at};
}

bool holds(const RenderTarget& target, VkExtent2D size) {
    const VkExtent2D has = target.radiance.extent();
    return has.width >= size.width && has.height >= size.height;
}

} // namespace

const RenderTarget* Targets::find(VkExtent2D size) const {
    for (const RenderTarget& target : targets_)
        if (holds(target, size)) return &target;
    return nullptr;
}

const RenderTarget& Targets::of(VkExtent2D size) const {
    const RenderTarget* target = find(size);
    if (!target) throw gpu::Error("no target holds this picture");
    return *target;
}

void Targets::makeRoom(std::span<const EyeRequest> eyes) {
    VkMemoryRequirements most{};
    for (const EyeRequest& eye : eyes) {
        if (find({eye.width, eye.height})) continue;
        const VkMemoryRequirements needs = placeOf(device_, {eye.width, eye.height}).bytes;
        if (needs.size > most.size) most = needs;
    }
    if (most.size > memory_.bytes()) {
        giveBack(); // first: the old and the new together are more than there may be
        memory_ = gpu::Allocation(device_, most, gpu::Memory::device, "target");
    }
    while (targets_.size() > kKept) { // the oldest first; those of `eyes` are made again
        if (&targets_.back() == used_) used_ = nullptr;
        targets_.pop_back();
    }
    for (const EyeRequest& eye : eyes)
        if (!find({eye.width, eye.height})) make({eye.width, eye.height});
}

void Targets::make(VkExtent2D size) {
    const Place place = placeOf(device_, size);
    RenderTarget target;
    target.radiance = gpu::Image(device_, radianceInfo(size), memory_, 0, "radiance");
    target.view_depth = gpu::Image(device_, depthInfo(size), memory_, place.depth, "view depth");
    targets_.push_front(std::move(target));
}

void Targets::use(VkCommandBuffer cmd, const RenderTarget& target) {
    if (&target == used_) return;
    gpu::everythingBefore(cmd);
    gpu::toGeneral(cmd, target.radiance);
    gpu::toGeneral(cmd, target.view_depth);
    used_ = &target;
}

void Targets::giveBack() {
    used_ = nullptr;
    targets_.clear();
    memory_ = {};
}

namespace {

template <class T>
void copy(VkCommandBuffer cmd, const gpu::Image& image, uint32_t width, Rows rows, const gpu::Buffer& to) {
    VkBufferImageCopy copy{};
    copy.bufferOffset = VkDeviceSize(width) * rows.first * sizeof(T);
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageOffset = {0, int32_t(rows.first), 0};
    copy.imageExtent = {width, rows.end - rows.first, 1};
    vkCmdCopyImageToBuffer(cmd, image.handle(), VK_IMAGE_LAYOUT_GENERAL, to.handle(), 1, &copy);
}

template <class T>
std::vector<T> read(const gpu::Device& device, const gpu::Image& image, VkExtent2D size) {
    const size_t count = size_t(size.width) * size.height;
    const gpu::Buffer pixels(device, count * sizeof(T), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback,
                             "target readback");
    gpu::Commands commands(device, "read target");
    const VkCommandBuffer cmd = commands.begin();
    gpu::everythingBefore(cmd);
    copy<T>(cmd, image, size.width, {0, size.height}, pixels);
    gpu::transferToHost(cmd);
    commands.submit();
    commands.wait(~0ull);
    pixels.invalidate();
    const std::span<T> mapped = pixels.mapped<T>(count);
    return {mapped.begin(), mapped.end()};
}

} // namespace

void copyRows(VkCommandBuffer cmd, const RenderTarget& target, uint32_t width, Rows rows, const gpu::Buffer& to) {
    copy<glm::vec4>(cmd, target.radiance, width, rows, to);
}

std::vector<glm::vec4> readTarget(const gpu::Device& device, const RenderTarget& target, VkExtent2D size) {
    return read<glm::vec4>(device, target.radiance, size);
}

std::vector<float> readDepths(const gpu::Device& device, const RenderTarget& target, VkExtent2D size) {
    return read<float>(device, target.view_depth, size);
}

std::vector<glm::vec4> interpolated(std::span<const glm::vec4> pixels, uint32_t nodes, VkExtent2D size, uint32_t step) {
    std::vector<glm::vec4> all;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x) {
            const glm::vec4 across = cubic(float(x % step) / float(step)), down = cubic(float(y % step) / float(step));
            glm::vec4& sum = all.emplace_back(0);
            for (uint32_t j = 0; j < 4; ++j)
                for (uint32_t i = 0; i < 4; ++i)
                    sum += across[int(i)] * down[int(j)] * pixels[size_t(y / step + j) * nodes + x / step + i];
        }
    return all;
}

} // namespace brume
