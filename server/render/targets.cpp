#include "server/render/targets.h"

#include <algorithm>

namespace brume {
namespace {

// Weights of the values at -1, 0, 1, 2: as in shaders/present.comp.
glm::vec4 cubic(float t) {
    return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
            (t + 1) * t * (t - 1) / 6};
}

} // namespace

void fitTarget(const gpu::Device& device, VkCommandBuffer cmd, RenderTarget& target, std::span<const EyeRequest> eyes) {
    VkExtent2D extent = target.radiance ? target.radiance.extent() : VkExtent2D{1, 1};
    for (const EyeRequest& eye : eyes)
        extent = {std::max(extent.width, eye.width), std::max(extent.height, eye.height)};
    const VkExtent2D has = target.radiance ? target.radiance.extent() : VkExtent2D{};
    if (extent.width == has.width && extent.height == has.height) return;
    const VkImageUsageFlags usage =
        VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    const VkImageUsageFlags copied = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    target.radiance = gpu::Image(device, {kRadianceFormat, extent, usage | copied}, "radiance");
    target.view_depth = gpu::Image(device, {VK_FORMAT_R32_SFLOAT, extent, usage}, "view depth");
    gpu::toGeneral(cmd, target.radiance);
    gpu::toGeneral(cmd, target.view_depth);
}

std::vector<glm::vec4> readTarget(const gpu::Device& device, const RenderTarget& target, VkExtent2D size) {
    const size_t count = size_t(size.width) * size.height;
    const gpu::Buffer pixels(device, count * sizeof(glm::vec4), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback,
                             "radiance readback");
    gpu::Commands commands(device, "read radiance");
    const VkCommandBuffer cmd = commands.begin();
    gpu::everythingBefore(cmd);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {size.width, size.height, 1};
    vkCmdCopyImageToBuffer(cmd, target.radiance.handle(), VK_IMAGE_LAYOUT_GENERAL, pixels.handle(), 1, &copy);
    gpu::transferToHost(cmd);
    commands.submit();
    commands.wait(~0ull);
    pixels.invalidate();
    const std::span<glm::vec4> mapped = pixels.mapped<glm::vec4>(count);
    return {mapped.begin(), mapped.end()};
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
